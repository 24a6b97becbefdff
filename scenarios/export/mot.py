"""MOTChallenge: the folder structure of TrackEval and common trackers.

gt/mot_challenge/seqmaps/peopleboy-all.txt               names of the sequences
gt/mot_challenge/peopleboy-all/SEQUENCE/seqinfo.ini      length, frame rate, size
/gt/gt.txt        truth
/img1/000001.png  images of the camera
/det/det.txt      detections of PeopleBoy's detector in each image, for thermal cameras
trackers/mot_challenge/peopleboy-all/TRACKER/data/SEQUENCE.txt

The boxes of gt.txt enclose torsos, as in the run itself, or whole people, including hidden parts.

The default camera is the thermal one. Images of any camera are numbered from 1. Results are written if the
tracker has boxes in its images.

Runs of a rendered set are written by split: instead of peopleboy-all there are peopleboy-train, peopleboy-val
and peopleboy-test.

The detections are those of single images, whatever the tracker of the run. Their boxes enclose torsos.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import cv2
import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.export.replay import OneCamera, Play, with_people, write_camera_images
from peopleboy.scenarios.export.splits import by_split
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import image_file
from peopleboy.scenarios.run_folder.run_files import true_boxes, truth_files
from peopleboy.scenarios.run_folder.run_tables import odometry_pose
from peopleboy.sim.cameras.camera_config import ThermalConfig, calibrations_of
from peopleboy.tracker.camera_mount import mount_of
from peopleboy.tracker.evaluation.mot_files import detection_line, truth_line
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.sensors.thermal.detector.detector import PeopleDetector
from peopleboy.tracker.tracking.config import ExistenceConfig

BENCHMARK, EVERYTHING = "peopleboy", "all"

# Class 8 of MOTChallenge, a distractor: neither a miss nor, if tracked, a false positive.
_DISTRACTOR = 8
_COUNTED, _CLASS, _VISIBLE = 6, 7, 8

_Sequences = dict[str, dict[str, OneCamera]]  # by name, then tracker


def write_mot(
    runs: Sequence[FinishedRun],
    folder: Path,
    play: Play,
    camera: str = "thermal",
    boxes: BoxKind = BoxKind.TORSO,
) -> None:
    """Write runs as sequences, by split; runs of several trackers on the same seed are one sequence.

    Args:
        runs: the runs to write.
        folder: output folder.
        play: returns the ticks of a run.
        camera: camera of the images and boxes.
        boxes: what the ground truth boxes enclose.

    Raises:
        BadInput: two runs are the same, the trackers have run on different sequences, only some runs have
            splits, or one has no such camera.
    """
    sorted_runs = {
        split: _sequences([with_people(run, camera) for run in own]) for split, own in by_split(runs).items()
    }
    for split, sequences in sorted_runs.items():
        _write_set(f"{BENCHMARK}-{split or EVERYTHING}", sequences, folder, play, boxes)


def _write_set(name: str, sequences: _Sequences, folder: Path, play: Play, boxes: BoxKind) -> None:
    truth, results = (folder / side / "mot_challenge" for side in ("gt", "trackers"))
    (truth / "seqmaps").mkdir(parents=True, exist_ok=True)
    lines = "".join(f"{line}\n" for line in ("name", *sequences))
    (truth / "seqmaps" / f"{name}.txt").write_text(lines, encoding="utf-8")
    for sequence, own in sequences.items():
        _write_sequence(sequence, next(iter(own.values())), truth / name / sequence, play, boxes)
        for tracker, shots in own.items():
            if shots.tracks_file.is_file():
                data = results / name / tracker / "data"
                data.mkdir(parents=True, exist_ok=True)
                (data / f"{sequence}.txt").write_text(tracks_text(shots), encoding="utf-8")


def tracks_text(shots: OneCamera) -> str:
    """Return the boxes of the tracker in a camera's images."""
    lines = shots.tracks_file.read_text(encoding="utf-8").splitlines()
    return "".join(f"{','.join(cells)}\n" for cells in _numbered(shots, lines))


def gt_text(shots: OneCamera, boxes: BoxKind = BoxKind.TORSO) -> str:
    """Return the truth in a camera's images, with people who do not count marked as distractors.

    These are people nearer than 3 m or farther than 10 m, and people who are not visible.
    """
    cells = _numbered(shots, _truth_lines(shots, boxes))
    return "".join(f"{','.join(_judged(each))}\n" for each in cells)


def _truth_lines(shots: OneCamera, boxes: BoxKind) -> list[str]:
    """Return one line for each person in each frame of the run, in the format of truth/gt.txt."""
    text, table = truth_files(shots.run.folder, shots.name)
    if boxes is BoxKind.TORSO:
        return text.read_text(encoding="utf-8").splitlines()
    truth = true_boxes(text, table, boxes)
    every = zip(truth.frame, truth.id, truth.box, truth.counted, truth.visible, strict=True)
    return [truth_line(*row).rstrip() for row in every]


def _numbered(shots: OneCamera, lines: Iterable[str]) -> Iterator[list[str]]:
    """Yield the cells of each line, with frames of the run replaced by image numbers of the camera."""
    for line in lines:
        frame, *rest = line.split(",")
        if int(frame) in shots.frames:
            yield [str(shots.number(int(frame))), *rest]


def _sequences(every: Sequence[OneCamera]) -> _Sequences:
    """Group runs by sequence and tracker."""
    found: _Sequences = {}
    for shots in every:
        run, tracker = shots.run, shots.run.about.tracker
        own = found.setdefault(f"{run.scenario.name}-{run.about.seed}", {})
        if tracker in own:
            raise BadInput(
                f"{run.folder}: same scenario, seed and tracker as {own[tracker].run.folder}; omit one"
            )
        if any(gt_text(shots) != gt_text(other) for other in own.values()):
            raise BadInput(
                f"{run.folder}: with tracker {tracker} the robot took another path, so the images differ; "
                "export one tracker at a time"
            )
        own[tracker] = shots
    everybody = {shots.run.about.tracker for shots in every}
    for name, own in found.items():
        for lacking in sorted(everybody - own.keys()):
            raise BadInput(f"{name}: no run with tracker {lacking}; export one tracker at a time")
    return found


def _write_sequence(name: str, shots: OneCamera, folder: Path, play: Play, boxes: BoxKind) -> None:
    for part in ("gt", "img1"):
        (folder / part).mkdir(parents=True)
    width, height = shots.size
    settings = {
        "name": name,
        "imDir": "img1",
        "frameRate": shots.rate_hz,
        "seqLength": len(shots.frames),
        "imWidth": width,
        "imHeight": height,
        "imExt": ".png",
    }
    lines = "".join(f"{key}={value}\n" for key, value in settings.items())
    (folder / "seqinfo.ini").write_text(f"[Sequence]\n{lines}", encoding="utf-8")
    (folder / "gt" / "gt.txt").write_text(gt_text(shots, boxes), encoding="utf-8")

    def image_path(number: int) -> Path:
        return folder / "img1" / image_file(number)

    write_camera_images(shots, play, image_path)
    if isinstance(shots.run.robot.cameras[shots.name], ThermalConfig):
        (folder / "det").mkdir()
        text = detections_text(shots, image_path)
        (folder / "det" / "det.txt").write_text(text, encoding="utf-8")


def _judged(cells: list[str]) -> list[str]:
    if cells[_COUNTED] == "1" and float(cells[_VISIBLE]) > 0.0:
        return cells
    return [*cells[:_COUNTED], "0", str(_DISTRACTOR), cells[_VISIBLE]]


def detections_text(shots: OneCamera, image_path: Callable[[int], Path]) -> str:
    """Return one line for each detection in a camera's images, with probabilities as scores.

    Each image is searched as a whole, without tracks. As in the tracker `detection`, the detector also uses
    the change since an image 0.2 s before, and the odometry.

    Args:
        shots: the camera and its run.
        image_path: returns the file of an image from its number, from 1.
    """
    run, lines = shots.run, list[str]()
    detector = PeopleDetector(least_score=ExistenceConfig().weakest)
    calibration = calibrations_of(run.robot.cameras)[shots.name]
    before: Pose2 | None = None
    for row in run.files().robot.to_pylist():
        if row["frame"] not in shots.frames:
            continue
        number, now = shots.number(row["frame"]), odometry_pose(row)
        grey = np.asarray(cv2.imread(str(image_path(number)), cv2.IMREAD_GRAYSCALE), np.uint8)
        moved = None if before is None else Odometry.between(before, now)
        found = detector.update(grey, row["time_s"], moved, mount_of(calibration, grey.shape[0]))
        lines += [
            detection_line(number, box, 1.0 / (1.0 + math.exp(-score)))
            for box, score in zip(found.box.tolist(), found.score.tolist(), strict=True)
        ]
        before = now
    return "".join(lines)
