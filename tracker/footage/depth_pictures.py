"""Matching of colour and depth pictures, by the numbers or timestamps in their names, or a list of pairs."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.picture_names import numbers_of
from peopleboy.tracker.footage.read_tiff import Raw
from peopleboy.tracker.footage.time_stamps import Floats, check_rising, time_stamps

TUM_APART_S: Final = 0.02
"""Greatest difference in time of a pair in the TUM RGB-D benchmark."""


@dataclass(frozen=True, slots=True, eq=False)
class PicturePairs:
    """Pairs of colour and depth pictures, or of other pictures of one moment.

    Attributes:
        colour: N files.
        depth: N files; a file may occur twice.
        time_s: (N,) since the first; None if the names are not timestamps.
        rate_hz: pairs per second, from the median interval; None if the names are not timestamps.
        note: which pictures were left out, for want of a partner; empty if none.
    """

    colour: Sequence[Path]
    depth: Sequence[Path]
    time_s: Floats | None = None
    rate_hz: float | None = None
    note: str = ""


def pair_up(colour: Sequence[Path], depth: Sequence[Path], other: str = "depth") -> PicturePairs:
    """Return the depth picture of each colour picture: the nearest in time if all names are timestamps.

    Names without times are paired by the TUM benchmark's `associations.txt`, by equal numbers, or, if both
    number all pictures in a row, by their order. A few colour pictures without depth are left out.

    Args:
        colour: at least one file, in order.
        depth: at least one file, in order.
        other: what the second ones are, for messages.

    Raises:
        BadInput: two pictures have the same time, half of the colour pictures have no partner, or the names
            do not say which pictures belong together.
    """
    listed = _listed(colour, depth)
    if listed is not None:
        kept = [k for k, path in enumerate(colour) if path.name in listed]
        places = {path.name: path for path in depth}
        found = [places[listed[colour[k].name]] for k in kept]
        return _with_times([colour[k] for k in kept], found, _left_out(colour, kept, other))
    times, depth_times = time_stamps(colour), time_stamps(depth)
    if times is None or depth_times is None or not _are_together(times, depth_times):
        return _by_number(colour, depth, other)
    by_time, depth_by_time = np.argsort(times), np.argsort(depth_times)
    colour, depth = [colour[k] for k in by_time], [depth[k] for k in depth_by_time]
    times, depth_times = times[by_time], depth_times[depth_by_time]
    step_s = _step(colour, times) if len(times) > 1 else None
    nearest = _nearest(depth_times, times)
    most_s = math.inf if step_s is None else max(step_s / 2, TUM_APART_S)
    away_s = np.abs(depth_times[nearest] - times)
    kept = np.flatnonzero(away_s <= most_s + 1e-6).tolist()  # names have no more decimals
    _check_near(colour, away_s, kept, most_s, other)
    found = [depth[nearest[k]] for k in kept]
    return _with_times([colour[k] for k in kept], found, _left_out(colour, kept, other))


def _with_times(colour: Sequence[Path], depth: Sequence[Path], note: str) -> PicturePairs:
    """Return pairs with the times in the names of the first, if there are any."""
    times = time_stamps(colour)
    if times is None:
        return PicturePairs(colour, depth, note=note)
    step_s = _step(colour, times) if len(times) > 1 else None
    rate_hz = None if step_s is None else 1.0 / step_s
    return PicturePairs(colour, depth, times - times[0], rate_hz, note)


_ASSOCIATIONS: Final = ("associations.txt", "associate.txt", "assoc.txt")


def _listed(colour: Sequence[Path], depth: Sequence[Path]) -> dict[str, str] | None:
    """Return the name of the depth picture by that of the colour picture, as a list of pairs says."""
    homes = [colour[0].parent.parent, colour[0].parent]
    file = next((home / name for home in homes for name in _ASSOCIATIONS if (home / name).is_file()), None)
    if file is None:
        return None
    here, there, listed = {path.name for path in colour}, {path.name for path in depth}, {}
    for line in file.read_text(encoding="utf-8", errors="replace").splitlines():
        names = [cell.replace("\\", "/").rsplit("/", 1)[-1] for cell in line.split()]
        folders = [cell.replace("\\", "/").rsplit("/", 1)[0].rsplit("/", 1)[-1] for cell in line.split()]
        mine = [
            n for n, f in zip(names, folders, strict=True) if n in here and f in (colour[0].parent.name, n)
        ]
        own = [
            n for n, f in zip(names, folders, strict=True) if n in there and f in (depth[0].parent.name, n)
        ]
        if mine and own:
            listed[mine[0]] = own[-1]
    return listed or None


def _are_together(times: Floats, others: Floats) -> bool:
    """Return whether two sets of times overlap; those of two clocks do not."""
    return bool(times.min() <= others.max() + 1.0 and others.min() <= times.max() + 1.0)


def _by_number(colour: Sequence[Path], depth: Sequence[Path], other: str) -> PicturePairs:
    """Pair pictures of equal numbers, or in order if both are numbered without a gap."""
    number, depth_number = numbers_of(colour), numbers_of(depth)
    if len(colour) == len(depth) == 1:
        return PicturePairs(colour, depth)
    if [path.stem for path in colour] == [path.stem for path in depth]:
        return PicturePairs(colour, depth)
    if number is None or depth_number is None or len(set(depth_number)) < len(depth):
        raise BadInput(_unclear(colour, depth, other))
    if len(colour) == len(depth) and _are_in_step(number, depth_number):
        return PicturePairs(colour, depth)
    places = {each: place for place, each in enumerate(depth_number)}
    kept = [k for k, each in enumerate(number) if each in places]
    if 2 * len(kept) <= max(len(colour), len(depth)):
        raise BadInput(_unclear(colour, depth, other))
    found = [depth[places[number[k]]] for k in kept]
    return PicturePairs([colour[k] for k in kept], found, note=_left_out(colour, kept, other))


def _are_in_step(number: Sequence[int], other: Sequence[int]) -> bool:
    """Return whether numbers rise alike, without a gap, wherever they begin."""
    steps = {after - before for each in (number, other) for before, after in pairwise(each)}
    return len(steps) == 1


def _unclear(colour: Sequence[Path], depth: Sequence[Path], other: str) -> str:
    names = f"such as {depth[0].name} and {colour[0].name}"
    if len(colour) != len(depth):
        return (
            f"{depth[0].parent}: must have as many pictures as {colour[0].parent}, {len(colour)}, got "
            f"{len(depth)}, or names, {names}, of the same numbers or with times in seconds, as 12.345678.png"
        )
    return (
        f"{depth[0].parent}: the names, {names}, do not say which {other} picture belongs to which of "
        f"{colour[0].parent}; give both the same numbers, or times in seconds, as 12.345678.png"
    )


def _left_out(colour: Sequence[Path], kept: Sequence[int], other: str) -> str:
    missing = sorted(set(range(len(colour))) - set(kept))
    if not missing:
        return ""
    return f"{colour[missing[0]]}: has no {other} picture; skipped: {len(missing)} of {len(colour)} pictures"


def _nearest(sorted_times: Floats, times: Floats) -> NDArray[np.int64]:
    """Return the index of the nearest of the sorted times for each of others (N,)."""
    after = np.searchsorted(sorted_times, times).clip(1, max(len(sorted_times) - 1, 1))
    before, last = after - 1, np.minimum(after, len(sorted_times) - 1)
    is_before = times - sorted_times[before] <= sorted_times[last] - times
    return np.where(is_before, before, last)


def _step(paths: Sequence[Path], times: Floats) -> float:
    """Return the median interval of pictures [s]."""
    check_rising(paths, times)
    return float(np.median(np.diff(times)))


def _check_near(
    paths: Sequence[Path], away_s: Floats, kept: Sequence[int], most_s: float, other: str
) -> None:
    count = len(paths) - len(kept)
    if 2 * count < len(paths):
        return
    first = int(np.setdiff1d(np.arange(len(paths)), kept)[0])
    raise BadInput(
        f"{paths[first]}: has no {other} picture within {most_s:.3f} s, the nearest is {away_s[first]:.3f} s "
        f"away; take out what has none (without {other}: {count} of {len(paths)} pictures)"
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
