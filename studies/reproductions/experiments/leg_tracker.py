"""Track legs with a laser scanner near the floor, as was usual before depth cameras."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from peopleboy.sim.observation import Observation
from peopleboy.tracker.frame import Floats, Odometry

HEIGHT_M: Final = 0.3
FARTHEST_M: Final = 5.0  # SA 4.7.7: legs are distinguished from other objects up to 3 to 5 m
FORWARD_M: Final = 0.3

_COLUMNS, _ROWS = 361, 16
_FOV_DEG: Final = math.degrees(2.0 * math.atan(_ROWS / _COLUMNS))  # portrait format; 90 degrees across
_YAWS_DEG: Final = {"legs_left": 45.0, "legs_right": -45.0}

CAMERAS: Final = {
    name: {
        "kind": "depth",
        "scale": 0.0,
        "colour": False,
        "width_px": _COLUMNS,
        "height_px": _ROWS,
        "vertical_fov_deg": _FOV_DEG,
        "mount_m": (FORWARD_M, 0.0, HEIGHT_M),
        "pitch_deg": 0.0,
        "yaw_deg": yaw_deg,
    }
    for name, yaw_deg in _YAWS_DEG.items()
}
"""Two noise-free depth cameras, one row of which forms a scan of half a circle."""

_GAP_M: Final = 0.12  # between neighbours of different objects
_LEG_M: Final = (0.05, 0.25)
_PAIR_M: Final = 0.5  # at most, between the legs of one person
_GATE_M: Final = 0.6
_BIRTHS, _PATIENCE = 4, 10  # frames


def scan(observation: Observation) -> Floats:
    """Return the points (N, 2) of half a circle, forward and left of the robot [m], from left to right."""
    parts = []
    for name, yaw_deg in _YAWS_DEG.items():
        depth = observation.images[name][_ROWS // 2].astype(np.float64) / 1000.0
        column = np.arange(_COLUMNS) - (_COLUMNS - 1) / 2.0
        ahead, left = depth, -column / (_COLUMNS / 2.0) * depth
        cosine, sine = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
        x, y = FORWARD_M + cosine * ahead - sine * left, sine * ahead + cosine * left
        parts.append(np.where(depth[:, None] > 0.0, np.stack([x, y], axis=1), np.nan))
    return np.concatenate(parts)


def find_people(points: Floats) -> list[tuple[float, float]]:
    """Return people from pairs of segments as wide as a leg, and from single segments."""
    legs = list(_legs(points))
    people = []
    while legs:
        leg = legs.pop(0)
        other = min(legs, key=lambda one: math.dist(one, leg), default=None)
        if other is not None and math.dist(other, leg) < _PAIR_M:
            legs.remove(other)
            leg = ((leg[0] + other[0]) / 2.0, (leg[1] + other[1]) / 2.0)
        people.append(leg)
    return people


@dataclass(frozen=True, slots=True)
class LegTrack:
    """A person tracked by legs: position, number of detections, and frames since the last one."""

    id: int
    place_m: tuple[float, float]
    seen: int = 1
    unseen: int = 0


class LegTracker:
    """Tracks legs from frame to frame: the nearest detection continues a track."""

    def __init__(self) -> None:
        self._tracks: list[LegTrack] = []
        self._last_id = 0

    def update(self, points: Floats, odometry: Odometry | None) -> list[LegTrack]:
        """Update the tracks with a scan, and return the confirmed ones."""
        found = find_people(points)
        kept = []
        for track in sorted((_predicted(one, odometry) for one in self._tracks), key=lambda one: -one.seen):
            nearest = min(found, key=lambda place: math.dist(place, track.place_m), default=None)
            if nearest is not None and math.dist(nearest, track.place_m) < _GATE_M:
                found.remove(nearest)
                kept.append(replace(track, place_m=nearest, seen=track.seen + 1, unseen=0))
            elif track.unseen < _PATIENCE:
                kept.append(replace(track, unseen=track.unseen + 1))
        for place in found:
            self._last_id += 1
            kept.append(LegTrack(self._last_id, place))
        self._tracks = kept
        return [track for track in kept if track.seen >= _BIRTHS]


def _legs(points: Floats) -> Iterator[tuple[float, float]]:
    """Return segments of the scan that are in front of their neighbours and as wide as legs."""
    reach = np.hypot(*points.T)
    for first, last in _segments(points):
        segment = points[first : last + 1]
        x, y = segment.mean(axis=0).tolist()
        is_leg = _LEG_M[0] <= math.dist(segment[0], segment[-1]) <= _LEG_M[1]
        if is_leg and math.hypot(x, y) <= FARTHEST_M and _stands_out(reach, first, last):
            yield x, y


def _segments(points: Floats) -> Iterator[tuple[int, int]]:
    gaps = np.hypot(*np.diff(points, axis=0).T)
    breaks = np.flatnonzero(~(gaps <= _GAP_M))  # a missing reading also separates segments
    starts, ends = [0, *(breaks + 1).tolist()], [*breaks.tolist(), len(points) - 1]
    for first, last in zip(starts, ends, strict=True):
        if np.isfinite(points[first : last + 1]).all():
            yield first, last


def _stands_out(reach: Floats, first: int, last: int) -> bool:
    return all(
        not 0 <= beside < len(reach) or not reach[beside] < reach[edge] + _GAP_M
        for edge, beside in ((first, first - 1), (last, last + 1))
    )


def _predicted(track: LegTrack, odometry: Odometry | None) -> LegTrack:
    """Transform a track's position to the robot's new frame."""
    if odometry is None:
        return track
    return replace(track, place_m=odometry.motion.to_local(track.place_m))
