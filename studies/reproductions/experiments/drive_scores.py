"""Score tracks on the floor against ground truth: hits, misses, false positives, errors."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from peopleboy.sim.truth.truth import PersonTruth, Truth
from peopleboy.tracker.sensors.depth.depth_view import DepthView
from peopleboy.tracker.track import Track

Floats = NDArray[np.float64]

FARTHEST_M: Final = 10.0
LEAST_PX: Final = 200  # minimum for a counted person; fewer are a hand or a foot
RADIUS_M: Final = 1.0
"""SA 4.7.2: a person is found if a track is within this distance."""

_PRIORITY_M: Final = 10.0  # preference of counted people in the assignment


@dataclass(frozen=True, slots=True)
class FloorPerson:
    """A person in the robot's frame at one instant.

    Attributes:
        place_m: forward, left of the robot [m], of the body's middle.
        surface_m: the same of the visible surface in the middle of the person; None for none.
        is_counted: whether a tracker should find the person.
        truth: ground truth of the person.
    """

    place_m: tuple[float, float]
    surface_m: tuple[float, float] | None
    is_counted: bool
    truth: PersonTruth


def people_on_floor(truth: Truth, view: DepthView) -> Iterator[FloorPerson]:
    """Return all people who are present, visible to a depth camera or not."""
    for person in truth.people:
        is_counted = person.visible_px > LEAST_PX and person.distance_m <= FARTHEST_M
        surface_m = _surface(person, truth, view) if is_counted else None
        yield FloorPerson(truth.robot.to_local(person.position_m), surface_m, is_counted, person)


def _surface(person: PersonTruth, truth: Truth, view: DepthView) -> tuple[float, float] | None:
    """Return the surface at the middle of a person's box, which the thesis uses as the person's position."""
    if person.visible_box is None:
        return None
    left, top, width, height = person.visible_box
    middle = left + width / 2.0
    inside = _middle_half(top, height), _middle_half(left, width)
    is_person = truth.instance[inside] == person.id
    if not is_person.any():
        return None
    z = float(np.median(truth.depth_m[inside][is_person]))
    forward, aside = view.on_floor(np.array([(middle - view.centre_u) * z / view.focal_px]), np.array([z]))[0]
    return float(forward), float(aside)


def _middle_half(first: float, size: float) -> slice:
    """Return the middle half of a box's rows or columns."""
    start = max(round(first + size / 4.0), 0)
    return slice(start, max(round(first + size * 3.0 / 4.0), start) + 1)


@dataclass(slots=True, eq=False)
class DriveScore:
    """Scores the tracks of a drive against ground truth.

    Tracks and people are assigned one to one, frame by frame, with the least sum of distances; counted people
    are preferred. A track on a person who is not counted is neither a hit nor a false positive.

    Attributes:
        body_m: [m] from the surface to the tracker's position of a person.
        hits: rows of frame, person, track, error forward and left [m] to the centre of the body, and both to
            the visible surface (None without one).
        missed: rows of frame, person.
        false: rows of frame, track, position forward and left [m].
        frames: number of frames.
    """

    body_m: float = 0.0
    hits: list[tuple[float | None, ...]] = field(default_factory=list)
    missed: list[tuple[int, int]] = field(default_factory=list)
    false: list[tuple[float, ...]] = field(default_factory=list)
    frames: int = 0

    def add(self, frame: int, people: Sequence[FloorPerson], tracks: Sequence[Track]) -> None:
        """Add a frame."""
        self.frames += 1
        places = np.array([track.place.position_m for track in tracks if track.place]).reshape(-1, 2)
        found = associate(people, places)
        for number, person in enumerate(people):
            if not person.is_counted:
                continue
            if number in found:
                track = found[number]
                self.hits.append(self._hit(frame, person, tracks[track].id, places[track]))
            else:
                self.missed.append((frame, person.truth.id))
        for number in sorted(set(range(len(places))) - set(found.values())):
            x, y = places[number].round(3).tolist()
            self.false.append((frame, tracks[number].id, x, y))

    def plain(self) -> dict[str, Any]:
        """Return the score as plain data."""
        return {"frames": self.frames, "hits": self.hits, "missed": self.missed, "false": self.false}

    def _hit(self, frame: int, person: FloorPerson, track: int, place: Floats) -> tuple[float | None, ...]:
        off = (place - person.place_m).round(4).tolist()
        surface: list[float | None] = [None, None]
        if person.surface_m is not None:
            front = place * (1.0 - self.body_m / max(float(np.hypot(*place)), 0.1))
            surface = (front - person.surface_m).round(4).tolist()
        return (frame, person.truth.id, track, *off, *surface)


def associate(people: Sequence[FloorPerson], places_m: Floats, radius_m: float = RADIUS_M) -> dict[int, int]:
    """Assign positions (N, 2) to people, one to one; return the index of the position by person."""
    if not people or not len(places_m):
        return {}
    standing = np.array([person.place_m for person in people])
    distance = np.hypot(*(standing[:, None] - places_m[None]).transpose(2, 0, 1))
    priority = np.where([person.is_counted for person in people], _PRIORITY_M, 0.0)
    never = 10.0 * _PRIORITY_M
    cost = np.where(distance <= radius_m, distance - priority[:, None], never)
    rows, columns = linear_sum_assignment(cost)
    return {int(r): int(c) for r, c in zip(rows, columns, strict=True) if cost[r, c] < never}


@dataclass(frozen=True, slots=True, eq=False)
class TrackingRecord:
    """The result of one drive, or of several together.

    Attributes:
        frames: number of frames.
        hits: (N, 7) rows as in `DriveScore`, NaN for None.
        missed: number of misses.
        false: number of false positives.
        switches: number of identity switches.
        ms: median time of a frame.
        bands: (4, 2) counted people, and those found by the pre-detection, by hidden share.
        false_sizes: number of false pre-detections.
    """

    frames: int
    hits: Floats
    missed: int
    false: int
    switches: int
    ms: float
    bands: NDArray[np.int64]
    false_sizes: int

    @classmethod
    def of_plain(cls, plain: Mapping[str, Any]) -> "TrackingRecord":
        """Read what `DriveTracking.plain` gave."""
        hits = hit_rows(plain)
        return cls(
            frames=plain["frames"],
            hits=hits,
            missed=len(plain["missed"]),
            false=len(plain["false"]),
            switches=_switches(hits),
            ms=plain["ms"],
            bands=np.array(plain["pre"]["bands"], dtype=np.int64),
            false_sizes=plain["pre"]["false"],
        )

    @classmethod
    def joined(cls, records: "Iterable[TrackingRecord]") -> "TrackingRecord":
        """Take drives together."""
        parts = list(records)
        join: dict[str, Callable[..., Any]] = {"hits": np.concatenate, "ms": np.mean}  # all others are sums
        columns = {one.name: [getattr(part, one.name) for part in parts] for one in fields(cls)}
        return cls(
            **{name: join.get(name, partial(np.sum, axis=0))(column) for name, column in columns.items()}
        )

    def found(self, radius_m: float = RADIUS_M) -> int:
        """Return the number of hits within a distance of the person."""
        return int(np.count_nonzero(self.error_m <= radius_m))

    def rate(self, radius_m: float = RADIUS_M) -> float:
        """Return the share of counted people who were found (SA eq. 4.30); NaN without people."""
        people = len(self.hits) + self.missed
        return self.found(radius_m) / people if people else float("nan")

    def false_per_frame(self, radius_m: float = RADIUS_M) -> float:
        """Return false positives per frame, including hits beyond the distance."""
        return (self.false + len(self.hits) - self.found(radius_m)) / self.frames

    @property
    def error_m(self) -> Floats:
        """Distance (N,) of each hit from the centre of the body [m]."""
        return np.asarray(np.hypot(self.hits[:, 3], self.hits[:, 4]))

    @property
    def surface_error_m(self) -> Floats:
        """Distance (M,) of each hit from the visible surface [m]."""
        errors = np.hypot(self.hits[:, 5], self.hits[:, 6])
        return np.asarray(errors[np.isfinite(errors)])

    @property
    def size_recall(self) -> Floats:
        """Recall (4,) of the pre-detection, by hidden share; NaN without people."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.bands[:, 1] / self.bands[:, 0])


def hit_rows(plain: Mapping[str, Any]) -> Floats:
    """Read the hits (N, 7) of a drive's plain data, NaN for None."""
    return np.array(plain["hits"], dtype=np.float64).reshape(-1, 7)


def _switches(hits: Floats) -> int:
    last: dict[float, float] = {}
    count = 0
    for _, person, track in hits[:, :3].tolist():
        count += last.get(person, track) != track
        last[person] = track
    return count
