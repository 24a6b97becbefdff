"""What a tracker did on drives, as figures: rates, false alarms, errors, and how sure they are."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.random_streams import stream
from peopleboy.studies.reproductions.depth_drives.score_drive import RADIUS_M

Floats = NDArray[np.float64]
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
