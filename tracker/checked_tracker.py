"""A wrapper that validates a tracker's output, so that mistakes are reported where they are made."""

import math
from array import array
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from numbers import Real
from time import perf_counter
from typing import Any

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.own_code import blamed
from peopleboy.tracker.evaluation.latency import TimedImages
from peopleboy.tracker.evaluation.sequence import FARTHEST, LARGEST
from peopleboy.tracker.footage.box_kinds import BoxKind, boxed_whole
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import FloorPlace, Status, Track
from peopleboy.tracker.trackers import Tracker, explanation_of


class CheckedTracker:
    """Returns a tracker's output after validating it, and times each update.

    Args:
        tracker: the wrapped tracker.
        who: name for messages, such as "tracker 'my_module:MyTracker'".
        cameras: names of the available cameras.
        boxes: what returned boxes enclose; None for the tracker's own boxes, unchanged.

    Attributes:
        times_ms: wall time of each update [ms], without the rendering of images.
    """

    def __init__(
        self, tracker: Tracker, who: str, cameras: Collection[str], boxes: BoxKind | None = None
    ) -> None:
        self._tracker = tracker
        self._who = who
        self._boxes = boxes
        self._known = frozenset(cameras)
        self.times_ms = array("d")

    @property
    def cameras(self) -> tuple[str, ...]:
        """The cameras of the tracker."""
        return self._tracker.cameras

    @property
    def explanation(self) -> object:
        """The tracker's explanation.

        Raises:
            OwnCodeFailed: the tracker raised an error.
        """
        with blamed(self._who):
            return explanation_of(self._tracker)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame and validate the output.

        Raises:
            BadInput: the output is not a tuple of valid tracks.
            OwnCodeFailed: it raised an error.
        """
        images = TimedImages(frame.images)
        timed = replace(frame, images=images)
        with blamed(self._who):
            start_s = perf_counter()
            tracks = self._tracker.update(timed)
            self.times_ms.append(1000.0 * (perf_counter() - start_s - images.spent_s))
            for fault in _faults(tracks, self._known):
                raise BadInput(fault)
        return boxed_whole(tracks, frame) if self._boxes is BoxKind.WHOLE else tracks


def _faults(tracks: object, cameras: Collection[str]) -> Iterator[str]:
    """Yield what is wrong with the output of `update`, and what would be right."""
    if not isinstance(tracks, tuple):
        yield f"update(frame) must return a tuple of Track, got {type(tracks).__name__}"
        return
    seen: set[int] = set()
    for track in tracks:
        if not isinstance(track, Track):
            yield f"update(frame) must return a tuple of Track, got a {type(track).__name__} in it"
            return
        if not _is_id(track.id):
            yield f"id must be a whole number from 1 to {LARGEST}, got {track.id!r}"
        if track.id in seen:
            yield f"ids must differ from each other in a frame, got {track.id} twice"
        seen.add(track.id)
        for fault in (*_box_faults(track.boxes, cameras), *_other_faults(track)):
            yield f"track {track.id}: {fault}"


def _box_faults(boxes: object, cameras: Collection[str]) -> Iterator[str]:
    if not isinstance(boxes, Mapping):
        yield f"boxes must be by camera, as {{'thermal': (left, top, width, height)}}, got {boxes!r}"
        return
    for camera, box in boxes.items():
        if camera not in cameras:
            yield f"boxes must be in images of {', '.join(sorted(cameras))}, got camera {camera!r}"
        if not _are_numbers(box, 4) or min(box[2:]) < 0.0:
            yield f"box in {camera!r} must be a tuple: finite left, top, width >= 0, height >= 0, got {box}"
        elif max(map(abs, box)) > FARTHEST:
            yield f"box in {camera!r} must be within +-{FARTHEST:.0e} pixels, got {box}"


def _place_faults(place: object) -> Iterator[str]:
    if place is None:
        return
    if not isinstance(place, FloorPlace):
        yield f"place must be None or a FloorPlace, got {place!r}"
        return
    if not _are_numbers(place.position_m, 2):
        yield f"position_m must be a tuple of finite metres ahead and left, got {place.position_m!r}"
    if not _are_numbers(place.covariance_m2, 3):
        yield f"covariance_m2 must be a tuple of finite xx, xy, yy, got {place.covariance_m2!r}"
    elif not _is_covariance(*place.covariance_m2):
        yield (
            "covariance_m2 must be a covariance: xx >= 0, yy >= 0 and xy no more than both allow, "
            f"got xx, xy, yy {place.covariance_m2!r}"
        )
    yield from _velocity_faults(place)


def _velocity_faults(place: FloorPlace) -> Iterator[str]:
    velocity, covariance = place.velocity_m_s, place.velocity_covariance_m2_s2
    if velocity is not None and not _are_numbers(velocity, 2):
        yield f"velocity_m_s must be None or a tuple of finite m/s ahead and left, got {velocity!r}"
    if covariance is not None and not (_are_numbers(covariance, 3) and _is_covariance(*covariance)):
        yield f"velocity_covariance_m2_s2 must be None or xx, xy, yy of a covariance, got {covariance!r}"


def _other_faults(track: Track) -> Iterator[str]:
    status = _one_of(Status, track.status)
    yield from _place_faults(track.place)
    if not _are_numbers((track.confidence,), 1) or not 0.0 <= track.confidence <= 1.0:
        yield f"confidence must be from 0 to 1, got {track.confidence!r}"
    if status:
        yield f"status must be {status}, got {track.status!r}"
    if not _are_numbers((track.age_s,), 1) or track.age_s < 0.0:
        yield f"age_s must be finite seconds from 0, got {track.age_s!r}"
    if track.occluder is not None and not _is_id(track.occluder):
        yield f"occluder must be None or the id of a track, got {track.occluder!r}"


def _one_of(kind: type[Status], value: object) -> str:
    """Return the valid names, unless the value is one of them."""
    return "" if isinstance(value, kind) else " or ".join(f"{kind.__name__}.{one.name}" for one in kind)


def _is_id(value: object) -> bool:
    """Return whether it is an integer that files keep exactly; True is not, though it equals 1."""
    return isinstance(value, int | np.integer) and type(value) is not bool and 1 <= int(value) <= LARGEST


def _is_covariance(xx: float, xy: float, yy: float) -> bool:
    """Return whether it is a possible error covariance, up to rounding."""
    return xx >= 0.0 and yy >= 0.0 and xy * xy <= xx * yy * (1.0 + 1e-6) + 1e-12


def _are_numbers(values: Any, count: int) -> bool:
    """Return whether it is a tuple of this many finite numbers."""
    if not isinstance(values, tuple) or len(values) != count:
        return False
    return all(isinstance(one, Real) and math.isfinite(one) for one in values)
