"""Matching of colour and depth pictures, by their order, or by the numbers or timestamps in their names."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.picture_names import numbers_in_a_row, numbers_of
from peopleboy.tracker.footage.read_picture import Raw

Floats = NDArray[np.float64]

TUM_APART_S: Final = 0.02
"""Greatest difference in time of a pair in the TUM RGB-D benchmark."""

STAMP: Final = re.compile(r"\d+\.\d+")
"""Seconds with decimals, as in the TUM RGB-D benchmark."""


@dataclass(frozen=True, slots=True, eq=False)
class PicturePairs:
    """Pairs of colour and depth pictures.

    Attributes:
        colour: N files.
        depth: N files; a file may occur twice.
        time_s: (N,) since the first; None if the names are not timestamps.
        rate_hz: pairs per second, from the median interval; None if the names are not timestamps.
        note: which colour pictures were left out, for want of depth; empty if none.
    """

    colour: Sequence[Path]
    depth: Sequence[Path]
    time_s: Floats | None = None
    rate_hz: float | None = None
    note: str = ""


def pair_up(colour: Sequence[Path], depth: Sequence[Path]) -> PicturePairs:
    """Return the depth picture of each colour picture: the nearest in time if all names are timestamps.

    A few colour pictures without depth are left out.

    Args:
        colour: at least one file, in order.
        depth: at least one file, in order.

    Raises:
        BadInput: numbers of pictures differ, two have the same time, or half of the colour pictures have no
            depth picture within half of a picture's interval.
    """
    times, depth_times = time_stamps(colour), time_stamps(depth)
    if times is None or depth_times is None:
        return _by_number(colour, depth) or _in_order(colour, depth)
    by_time, depth_by_time = np.argsort(times), np.argsort(depth_times)
    colour, depth = [colour[k] for k in by_time], [depth[k] for k in depth_by_time]
    times, depth_times = times[by_time], depth_times[depth_by_time]
    step_s = _step(colour, times) if len(times) > 1 else None
    nearest = _nearest(depth_times, times)
    most_s = math.inf if step_s is None else max(step_s / 2, TUM_APART_S)
    away_s = np.abs(depth_times[nearest] - times)
    kept = np.flatnonzero(away_s <= most_s + 1e-6)  # names have no more decimals
    _check_near(colour, away_s, kept, most_s)
    return PicturePairs(
        colour=[colour[k] for k in kept],
        depth=[depth[nearest[k]] for k in kept],
        time_s=times[kept] - times[kept[0]],
        rate_hz=None if step_s is None else 1.0 / step_s,
        note=_left_out(colour, kept.tolist()),
    )


def time_stamps(paths: Sequence[Path]) -> Floats | None:
    """Return names as seconds (N,); None if one of them is not a timestamp."""
    if not all(STAMP.fullmatch(path.stem) for path in paths):
        return None
    return np.array([float(path.stem) for path in paths])


def _by_number(colour: Sequence[Path], depth: Sequence[Path]) -> PicturePairs | None:
    """Pair pictures of equal numbers; None if names have none, most differ, or none is missing."""
    number, depth_number = numbers_of(colour), numbers_of(depth)
    if number is None or depth_number is None or len(set(depth_number)) < len(depth):
        return None
    if len(colour) == len(depth) and numbers_in_a_row(colour) and numbers_in_a_row(depth):
        return None
    places = {each: place for place, each in enumerate(depth_number)}
    kept = [k for k, each in enumerate(number) if each in places]
    if 2 * len(kept) <= max(len(colour), len(depth)):
        return None
    found = [depth[places[number[k]]] for k in kept]
    return PicturePairs([colour[k] for k in kept], found, note=_left_out(colour, kept))


def _left_out(colour: Sequence[Path], kept: Sequence[int]) -> str:
    missing = sorted(set(range(len(colour))) - set(kept))
    if not missing:
        return ""
    return f"{colour[missing[0]]}: has no depth picture; skipped: {len(missing)} of {len(colour)} pictures"


def _in_order(colour: Sequence[Path], depth: Sequence[Path]) -> PicturePairs:
    if len(colour) != len(depth):
        raise BadInput(
            f"{depth[0].parent}: must have as many pictures as {colour[0].parent}, {len(colour)}, "
            f"got {len(depth)}; pictures whose names are seconds, as 12.345678.png, go together by time"
        )
    return PicturePairs(colour, depth)


def _nearest(sorted_times: Floats, times: Floats) -> NDArray[np.int64]:
    """Return the index of the nearest of the sorted times for each of others (N,)."""
    after = np.searchsorted(sorted_times, times).clip(1, max(len(sorted_times) - 1, 1))
    before, last = after - 1, np.minimum(after, len(sorted_times) - 1)
    is_before = times - sorted_times[before] <= sorted_times[last] - times
    return np.where(is_before, before, last)


def _step(paths: Sequence[Path], times: Floats) -> float:
    """Return the median interval of pictures [s]."""
    steps = np.diff(times)
    if not steps.all():
        twice = paths[int(np.argmin(steps)) + 1]
        raise BadInput(f"{twice}: another picture has the same time; keep one")
    return float(np.median(steps))


def _check_near(paths: Sequence[Path], away_s: Floats, kept: NDArray[np.int64], most_s: float) -> None:
    count = len(paths) - len(kept)
    if 2 * count < len(paths):
        return
    first = int(np.setdiff1d(np.arange(len(paths)), kept)[0])
    raise BadInput(
        f"{paths[first]}: has no depth picture within {most_s:.3f} s, the nearest is {away_s[first]:.3f} s "
        f"away; take out what has none (without depth: {count} of {len(paths)} pictures)"
    )


# Units of recorded depth images.

MILLIMETRES: Final = 0.001
TUM: Final = 0.0002
"""Metres per count of most sensors' drivers."""

PLAUSIBLE_M: Final = (0.2, 30.0)
"""Range in which the median depth of a place with people lies."""


class DepthCounts:
    """Converts counts to millimetres.

    Args:
        folder: of the pictures, for messages.
        m_per_count: metres per count; a count of 0 is no reading.

    Raises:
        BadInput: it is not positive and finite.
    """

    def __init__(self, folder: Path, m_per_count: float) -> None:
        if not 0.0 < m_per_count < math.inf:
            raise BadInput(
                f"--depth-scale must be above 0, metres per count such as {MILLIMETRES}, got {m_per_count:g}"
            )
        self._folder, self.m_per_count = folder, m_per_count
        millimetres = np.rint(1000.0 * m_per_count * np.arange(65536.0))
        self._millimetres = np.where(millimetres <= 65535.0, millimetres, 0.0).astype(np.uint16)

    def __call__(self, picture: Raw) -> NDArray[np.uint16]:
        """Return the depths (H, W) [mm] of counts; 0 for no reading and for more than 65.5 m.

        Raises:
            BadInput: the picture does not have 16-bit counts.
        """
        if picture.dtype != np.uint16:
            raise BadInput(
                f"{self._folder}: depth pictures must be 16-bit counts (PNG or TIFF), got {picture.dtype}"
            )
        return np.asarray(self._millimetres[picture])

    def check_plausible(self, picture: Raw) -> None:
        """Refuse a scale that gives implausible depths for the counts (H, W) of a picture.

        Raises:
            BadInput: half of the readings are nearer or farther than `PLAUSIBLE_M`.
        """
        read = picture[picture > 0]
        if not len(read) or _is_plausible(median := float(np.median(read)), self.m_per_count):
            return
        fitting = [scale for scale in (MILLIMETRES, TUM) if _is_plausible(median, scale)]
        advice = f"; is it --depth-scale {fitting[0]:g}?" if fitting else ""
        low, high = PLAUSIBLE_M
        raise BadInput(
            f"--depth-scale {self.m_per_count:g}: half of what is read in {self._folder} is then beyond "
            f"{median * self.m_per_count:.3g} m, which should be {low:g}..{high:g}{advice}"
        )


def _is_plausible(counts: float, m_per_count: float) -> bool:
    low, high = PLAUSIBLE_M
    return low <= counts * m_per_count <= high
