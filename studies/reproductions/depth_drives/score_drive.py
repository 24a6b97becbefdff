"""How well a tracker tells where people are on the floor: hits, misses, false alarms, and errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from peopleboy.studies.reproductions.depth_drives.play_drive import Stander
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
