"""How well a tracker tells where people are on the floor: hits, misses, false alarms, and errors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from peopleboy.sim.random_streams import stream
from peopleboy.studies.reproductions.evaluations.playback import Stander
from peopleboy.tracker.track import Track

Floats = NDArray[np.float64]

RADIUS_M: Final = 1.0
"""SA 4.7.2: who is told within this distance is found."""

_FIRST: Final = 10.0  # by which those who count are preferred to others [m]


@dataclass(slots=True, eq=False)
class DriveScore:
    """What a tracker said of a drive, held against the truth.

    Tracks and people are matched one to one, frame by frame, so that distances are least in all; those who
    count go first. A track on somebody who does not count is neither right nor wrong.

    Attributes:
        body_m: [m] from the surface to where the tracker puts a person.
        hits: rows of frame, person, track, error forward and left [m] against the body's middle, and both
            against the surface that is seen (NaN as None where there is none).
        missed: rows of frame, person.
        false: rows of frame, track, place forward and left [m].
        frames: how many.
    """

    body_m: float = 0.0
    hits: list[tuple[float | None, ...]] = field(default_factory=list)
    missed: list[tuple[int, int]] = field(default_factory=list)
    false: list[tuple[float, ...]] = field(default_factory=list)
    frames: int = 0

    def add(self, frame: int, people: Sequence[Stander], tracks: Sequence[Track]) -> None:
        """Take in a frame."""
        self.frames += 1
        places = np.array([track.place.position_m for track in tracks if track.place]).reshape(-1, 2)
        found = match(people, places)
        for number, person in enumerate(people):
            if not person.is_counted:
                continue
            if number in found:
                track = found[number]
                self.hits.append(self._hit(frame, person, tracks[track].id, places[track]))
            else:
                self.missed.append((frame, person.id))
        for number in sorted(set(range(len(places))) - set(found.values())):
            x, y = places[number].round(3).tolist()
            self.false.append((frame, tracks[number].id, x, y))

    def plain(self) -> dict[str, Any]:
        """Give it as plain data."""
        return {"frames": self.frames, "hits": self.hits, "missed": self.missed, "false": self.false}

    def _hit(self, frame: int, person: Stander, track: int, place: Floats) -> tuple[float | None, ...]:
        off = (place - person.place_m).round(4).tolist()
        surface: list[float | None] = [None, None]
        if person.surface_m is not None:
            front = place * (1.0 - self.body_m / max(float(np.hypot(*place)), 0.1))
            surface = (front - person.surface_m).round(4).tolist()
        return (frame, person.id, track, *off, *surface)


def match(people: Sequence[Stander], places_m: Floats, radius_m: float = RADIUS_M) -> dict[int, int]:
    """Match people with places (N, 2), one to one; give the place's number by the person's."""
    if not people or not len(places_m):
        return {}
    standing = np.array([person.place_m for person in people])
    apart = np.hypot(*(standing[:, None] - places_m[None]).transpose(2, 0, 1))
    first = np.where([person.is_counted for person in people], _FIRST, 0.0)
    never = 10.0 * _FIRST
    cost = np.where(apart <= radius_m, apart - first[:, None], never)
    rows, columns = linear_sum_assignment(cost)
    return {int(r): int(c) for r, c in zip(rows, columns, strict=True) if cost[r, c] < never}


# What a tracker did on drives, as figures: rates, false alarms, errors, and how sure they are.

T = TypeVar("T")

CLOSE_M: Final = 0.3
_DRAWS: Final = 2000


@dataclass(frozen=True, slots=True, eq=False)
class DriveRecord:
    """What came of one drive, or of several together.

    Attributes:
        frames: how many.
        hits: (N, 7) rows as in `DriveScore`, NaN for None.
        missed: how often somebody was.
        false: how many false alarms.
        switches: how often somebody's track was another one than the last time.
        ms: median time of a frame.
        bands: (4, 2) who counts and who of them the pre-detection found, by the share that is hidden.
        false_sizes: how many pre-detections were of nobody.
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
    def of_plain(cls, plain: Mapping[str, Any]) -> DriveRecord:
        """Read what `Watcher.plain` gave."""
        hits = np.array(plain["hits"], dtype=np.float64).reshape(-1, 7)
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
    def joined(cls, records: Iterable[DriveRecord]) -> DriveRecord:
        """Take drives together."""
        parts = list(records)
        return cls(
            frames=sum(one.frames for one in parts),
            hits=np.concatenate([one.hits for one in parts]),
            missed=sum(one.missed for one in parts),
            false=sum(one.false for one in parts),
            switches=sum(one.switches for one in parts),
            ms=float(np.mean([one.ms for one in parts])),
            bands=np.sum([one.bands for one in parts], axis=0),
            false_sizes=sum(one.false_sizes for one in parts),
        )

    def found(self, radius_m: float = RADIUS_M) -> int:
        """Count who was told to be within a distance of where they are."""
        return int(np.count_nonzero(self.error_m <= radius_m))

    def rate(self, radius_m: float = RADIUS_M) -> float:
        """Tell which share of those who count was found (SA eq. 4.30); NaN if there was nobody."""
        everybody = len(self.hits) + self.missed
        return self.found(radius_m) / everybody if everybody else float("nan")

    def false_per_frame(self, radius_m: float = RADIUS_M) -> float:
        """Count tracks on nobody; those on somebody who is too far away, too."""
        return (self.false + len(self.hits) - self.found(radius_m)) / self.frames

    @property
    def error_m(self) -> Floats:
        """(N,) distance of each hit from the middle of the body [m]."""
        return np.asarray(np.hypot(self.hits[:, 3], self.hits[:, 4]))

    @property
    def surface_error_m(self) -> Floats:
        """(M,) distance of each hit from the surface that is seen [m]."""
        errors = np.hypot(self.hits[:, 5], self.hits[:, 6])
        return np.asarray(errors[np.isfinite(errors)])

    @property
    def size_recall(self) -> Floats:
        """(4,) share whom the pre-detection found, by the share that is hidden; NaN for nobody."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.bands[:, 1] / self.bands[:, 0])


def interval(
    parts: Sequence[T], measure: Callable[[Sequence[T]], float], share: float = 0.95
) -> tuple[float, float]:
    """Give the interval of a figure by drawing parts, such as seeds, with replacement; NaN for one part."""
    if len(parts) < 2:
        return float("nan"), float("nan")
    rng = stream(0, "depth_drives.interval")
    drawn = rng.integers(0, len(parts), (_DRAWS, len(parts)))
    figures = [measure([parts[k] for k in row]) for row in drawn]
    low, high = np.nanquantile(figures, [(1.0 - share) / 2.0, (1.0 + share) / 2.0]).tolist()
    return low, high


def _switches(hits: Floats) -> int:
    last: dict[float, float] = {}
    count = 0
    for _, person, track in hits[:, :3].tolist():
        count += last.get(person, track) != track
        last[person] = track
    return count
