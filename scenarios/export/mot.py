"""MOTChallenge: folders as TrackEval and everybody's trackers read them.

gt/mot_challenge/seqmaps/peopleboy-all.txt               names of the sequences
gt/mot_challenge/peopleboy-all/SEQUENCE/seqinfo.ini      length, frame rate, size
/gt/gt.txt        truth
/img1/000001.png  thermal images
trackers/mot_challenge/peopleboy-all/TRACKER/data/SEQUENCE.txt

Runs of a rendered set are written by split: instead of peopleboy-all there are peopleboy-train, peopleboy-val
and peopleboy-test.

There is no det/det.txt: nothing in a run finds people in single images, and truth is no detection.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.by_split import by_split
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import write_png

BENCHMARK, EVERYTHING = "peopleboy", "all"

# Class 8 of MOTChallenge, a distractor: neither missed nor, if a tracker finds it, a false alarm.
_DISTRACTOR = 8
_COUNTED, _CLASS, _VISIBLE = 6, 7, 8

_Sequences = dict[str, dict[str, FinishedRun]]  # by name, then tracker


def write_mot(runs: Sequence[FinishedRun], folder: Path, play: Play) -> None:
    """Write runs as sequences, by split; runs of several trackers on the same seed are one sequence.

    Raises:
        BadInput: two runs are the same, or the trackers have not seen the same sequences, or the runs cannot
            be sorted by split.
    """
    sorted_runs = {split: _sequences(own) for split, own in by_split(runs).items()}
    for split, sequences in sorted_runs.items():
        _write_set(f"{BENCHMARK}-{split or EVERYTHING}", sequences, folder, play)


def _write_set(name: str, sequences: _Sequences, folder: Path, play: Play) -> None:
    truth, results = (folder / side / "mot_challenge" for side in ("gt", "trackers"))
    (truth / "seqmaps").mkdir(parents=True, exist_ok=True)
    lines = "".join(f"{line}\n" for line in ("name", *sequences))
    (truth / "seqmaps" / f"{name}.txt").write_text(lines, encoding="utf-8")
    for sequence, own in sequences.items():
        _write_sequence(sequence, next(iter(own.values())), truth / name / sequence, play)
        for tracker, run in own.items():
            data = results / name / tracker / "data"
            data.mkdir(parents=True, exist_ok=True)
            (data / f"{sequence}.txt").write_bytes((run.folder / "tracks.txt").read_bytes())


def gt_text(run: FinishedRun) -> str:
    """Give a run's truth with everybody whom our own scores leave out marked as a distractor.

    These are people nearer than 3 m or farther than 10 m, and those of whom nothing is visible.
    """
    lines = (run.folder / "truth" / "gt.txt").read_text(encoding="utf-8").splitlines()
    return "".join(f"{','.join(_judged(line.split(',')))}\n" for line in lines)


def _sequences(runs: Sequence[FinishedRun]) -> _Sequences:
    """Sort runs by sequence and tracker."""
    found: _Sequences = {}
    for run in runs:
        tracker = run.about.tracker
        own = found.setdefault(f"{run.scenario.name}-{run.about.seed}", {})
        if tracker in own:
            raise BadInput(
                f"{run.folder}: same scenario, seed and tracker as {own[tracker].folder}; leave one out"
            )
        if any(gt_text(run) != gt_text(other) for other in own.values()):
            raise BadInput(
                f"{run.folder}: with tracker {tracker} the robot went elsewhere, so the images differ; "
                "export one tracker at a time"
            )
        own[tracker] = run
    everybody = {run.about.tracker for run in runs}
    for name, own in found.items():
        for lacking in sorted(everybody - own.keys()):
            raise BadInput(
                f"{name}: there is no run of it with tracker {lacking}; export one tracker at a time"
            )
    return found


def _write_sequence(name: str, run: FinishedRun, folder: Path, play: Play) -> None:
    for part in ("gt", "img1"):
        (folder / part).mkdir(parents=True)
    camera = run.robot.cameras["thermal"].camera
    settings = {
        "name": name,
        "imDir": "img1",
        "frameRate": run.rate_hz,
        "seqLength": run.frames,
        "imWidth": camera.width,
        "imHeight": camera.height,
        "imExt": ".png",
    }
    lines = "".join(f"{key}={value}\n" for key, value in settings.items())
    (folder / "seqinfo.ini").write_text(f"[Sequence]\n{lines}", encoding="utf-8")
    (folder / "gt" / "gt.txt").write_text(gt_text(run), encoding="utf-8")
    _write_images(run, folder / "img1", play)


def _write_images(run: FinishedRun, folder: Path, play: Play) -> None:
    """Copy the run's thermal images if it has written them, else render them again."""
    names = [f"{frame:06d}.png" for frame in range(1, run.frames + 1)]
    written = [run.folder / "thermal" / name for name in names]
    if all(path.is_file() for path in written):
        for path in written:
            (folder / path.name).write_bytes(path.read_bytes())
        return
    for tick in play(run):
        write_png(folder / f"{tick.frame:06d}.png", tick.observation.images["thermal"])


def _judged(cells: list[str]) -> list[str]:
    if cells[_COUNTED] == "1" and float(cells[_VISIBLE]) > 0.0:
        return cells
    return [*cells[:_COUNTED], "0", str(_DISTRACTOR), cells[_VISIBLE]]
