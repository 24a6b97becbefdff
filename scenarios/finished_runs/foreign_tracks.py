"""Tracks from elsewhere: read, held against the run that they are said to be of, and turned into ours."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.camera_images import OneCamera, one_camera
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.run_files import check_end
from peopleboy.sim.cameras.kinds import with_boxes
from peopleboy.tracker.evaluation.mot_files import read_tracks
from peopleboy.tracker.evaluation.sequence import TrackBoxes
from peopleboy.tracker.track import Status, Track

UNKNOWN = ("status", "place", "occluder")
"""What MOTChallenge text does not tell of a track."""

_MOST_OUTSIDE = 0.5  # of the boxes; of another run or camera, or in an image of another size, are more


def foreign_tracks(path: Path, run: FinishedRun, camera: str) -> Mapping[int, tuple[Track, ...]]:
    """Read MOTChallenge results, and give the tracks of each frame of the run that has some.

    Their images are counted as exports count them: 1, 2, 3 ..., also those of a camera that takes none in
    most frames of the run. Their status and place are unknown; their age is counted from their first box on.

    Args:
        path: the file.
        run: whose images they were made of.
        camera: in whose images the boxes are.

    Raises:
        BadInput: the file is malformed, or cannot be of this run and camera.
    """
    boxes = read_tracks(path)
    shots = _shots(run, camera)
    _check_end(boxes, path, shots)
    _check_view(boxes, path, shots)
    if len(boxes) and boxes.id.min() < 1:
        raise BadInput(f"{path}: ids must be from 1 on, got 0; add 1 to all")
    first: dict[int, float] = {}
    found: dict[int, list[Track]] = defaultdict(list)
    columns = (boxes.frame.tolist(), boxes.id.tolist(), boxes.box.tolist(), boxes.confidence.tolist())
    for image, number, (left, top, width, height), confidence in zip(*columns, strict=True):
        frame = shots.frames[image - 1]
        time_s = run.time_s(frame)
        found[frame].append(
            Track(
                id=number,
                boxes={camera: (left, top, width, height)},
                confidence=confidence,
                status=Status.UNKNOWN,
                age_s=time_s - first.setdefault(number, time_s),
            )
        )
    return {frame: tuple(tracks) for frame, tracks in found.items()}


def _shots(run: FinishedRun, camera: str) -> OneCamera:
    """Find the camera, which the run may not have."""
    known = with_boxes(run.robot.cameras)
    if camera not in known:
        raise BadInput(f"--camera {camera}: {run.folder} has boxes in images of {', '.join(known)}")
    return one_camera(run, camera)


def _check_end(boxes: TrackBoxes, path: Path, shots: OneCamera) -> None:
    """Refuse boxes beyond the last image, such as those of a slow camera by numbers of the run's frames."""
    if shots.every == 1:
        check_end(boxes, path, shots.run.frames)
    elif boxes.last_frame > len(shots.frames):
        raise BadInput(
            f"{path}: must end with image {len(shots.frames)}, the last of camera {shots.name!r}, got "
            f"{boxes.last_frame}; count them 1, 2, 3 ... as exports do, not by frames of the run"
        )


def _check_view(boxes: TrackBoxes, path: Path, shots: OneCamera) -> None:
    """Refuse boxes that are not in the camera's image."""
    width, height = shots.size
    u, v = (boxes.box[:, :2] + boxes.box[:, 2:] / 2.0).T
    outside = ~((u >= 0.0) & (u <= width) & (v >= 0.0) & (v <= height))
    if len(boxes) and outside.mean() > _MOST_OUTSIDE:
        raise BadInput(
            f"{path}: boxes must be in pixels of the {width} x {height} images of camera {shots.name!r}; "
            f"{outside.mean():.0%} of them have their middle outside"
        )
