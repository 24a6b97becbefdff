"""The background behind each pixel, what stands before it, and what may become either: confirmed readings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.scene_model.readings import Readings
from peopleboy.tracker.scene_model.scene import Metres

Bools = NDArray[np.bool_]

NEVER: Final = -1e6
"""[s] When something happened that never did."""

_FORGET: Final = np.float32(3000.0)  # readings from which on a mean follows the newest ones
_FEW, _OFTENER, _FLIPS = np.float32(25.0), np.float32(2.0), np.float32(3.0)
_LEAST: Final = 8.0  # so many of them at least
_SURE: Final = 0.2  # of the readings of a surface must agree with their neighbours


@dataclass(frozen=True, slots=True, eq=False)
class Layers:
    """What is known of every pixel of a standing camera; its arrays are (H, W) and change from frame to frame.

    Depths are kept inverted [1/m], as the noise of sensors is alike there and a mean of raw readings has no
    bias by it.

    Attributes:
        back, back_count: mean of the readings of the background, and their number; 0 where never seen.
        back_sure: how many of them had neighbours that agree.
        back_seen_s: when it was seen last.
        front, front_count: the same of a thing before it; 0 where none stands.
        front_since_s, front_seen_s: when that was seen first and last.
        other, other_count, other_since_s: the same of readings that fit neither, in a row.
        gone: readings of the background in a row where a thing is remembered.
        kind: of the newest reading: background 0, thing 1, neither 2.
        flips: how often it changed from background to thing since this stands there.
        before: readings of the background before this stood there.
        past: [1/m] what was taken for background until something farther was seen; 0 for nothing.
        past_seen_s, past_gone_s: when that was seen last, and what is farther first.
    """

    back: Metres
    back_count: Metres
    back_sure: Metres
    back_seen_s: Metres
    front: Metres
    front_count: Metres
    front_since_s: Metres
    front_seen_s: Metres
    other: Metres
    other_count: Metres
    other_since_s: Metres
    gone: Metres
    kind: Metres
    flips: Metres
    before: Metres
    past: Metres
    past_seen_s: Metres
    past_gone_s: Metres

    @classmethod
    def of_size(cls, height: int, width: int) -> Layers:
        """Know nothing yet."""
        kinds = {name: 0.0 for name in cls.__slots__}
        times = {name: NEVER for name in kinds if name.endswith("_s")}
        return cls(**{name: np.full((height, width), at, np.float32) for name, at in (kinds | times).items()})

    @property
    def arrays(self) -> tuple[Metres, ...]:
        """All of it, in order."""
        return tuple(getattr(self, name) for name in self.__slots__)

    @property
    def background_m(self) -> Metres:
        """(H, W) depth of what is taken for background [m]; 0 where nothing was ever read."""
        return inverted(self.back)

    @property
    def surface_m(self) -> Metres:
        """(H, W) the same, 0 also where light of several surfaces mixes."""
        is_sure = (self.back_sure > _SURE * self.back_count) & (self.back_sure >= _LEAST)
        return np.where(is_sure, self.background_m, np.float32(0.0))


def inverted(values: Metres) -> Metres:
    """Turn depths [m] into inverse ones and back; 0 stays 0."""
    return np.asarray(np.divide(1.0, values, out=np.zeros_like(values), where=values > 0.0), np.float32)


def take_in(
    layers: Layers, readings: Readings, reach_m: Metres, ignored: Bools, time_s: float, confirm: int
) -> None:
    """Sort the readings of a frame into the layers.

    A reading that fits neither background nor thing is believed after some in a row that agree: it becomes
    the background if it is farther, and a thing before it if it is nearer. What people hide is remembered.

    Args:
        layers: to be changed.
        readings: of the frame; the smooth ones are sorted, the raw ones make the means.
        reach_m: (H, W) within which two readings agree [m].
        ignored: (H, W) where people are.
        time_s: of the frame.
        confirm: readings in a row that are believed.
    """
    _sort(*layers.arrays, readings.raw_m, readings.smooth_m, readings.is_mixed, reach_m, ignored, np.float32(time_s), np.float32(confirm))


@njit(cache=True, nogil=True)
def _sort(
    back, back_count, back_sure, back_seen, front, front_count, front_since, front_seen, other, other_count, other_since,
    gone, kind, flips, before, past, past_seen, past_gone, raw, smooth, mixed, reach, ignored, now, confirm,
):  # type: ignore[no-untyped-def]  # fmt: skip
    height, width = raw.shape
    for v in range(height):
        for u in range(width):
            z = smooth[v, u]
            if z <= 0.0 or ignored[v, u]:
                continue
            near = reach[v, u]
            reading = 1.0 / raw[v, u]
            if back_count[v, u] == 0.0:
                back[v, u], back_count[v, u], back_seen[v, u] = reading, 1.0, now
                continue
            is_front = front_count[v, u] > 0.0 and abs(z - 1.0 / front[v, u]) < near
            is_back = not is_front and abs(z - 1.0 / back[v, u]) < near
            new_kind = np.float32(1.0 if is_front else (0.0 if is_back else 2.0))
            flips[v, u] += is_front and kind[v, u] == 0.0
            kind[v, u] = new_kind
            if is_front:
                _add(front, front_count, v, u, reading, near)
                front_seen[v, u], gone[v, u], other_count[v, u] = now, 0.0, 0.0
                is_better = front_count[v, u] > _OFTENER * back_count[v, u]
                is_near = 1.0 / back[v, u] - z < 2.0 * near
                if is_better and before[v, u] < _FEW and (is_near or flips[v, u] >= _FLIPS):  # what was read first was an outlier
                    back[v, u], back_count[v, u] = front[v, u], front_count[v, u]
                    back_sure[v, u], back_seen[v, u], front_count[v, u] = front_count[v, u], now, 0.0
                continue
            if is_back:
                _add(back, back_count, v, u, reading, near)
                back_sure[v, u] += not mixed[v, u]
                other_count[v, u] = 0.0
                gone[v, u] += 1.0
                if front_count[v, u] == 0.0 or gone[v, u] >= confirm:
                    back_seen[v, u], front_count[v, u], gone[v, u] = now, 0.0, 0.0
                continue
            if other_count[v, u] > 0.0 and abs(z - 1.0 / other[v, u]) < near:
                _add(other, other_count, v, u, reading, near)
            else:
                other[v, u], other_count[v, u], other_since[v, u] = reading, 1.0, now
            if other_count[v, u] < confirm:
                continue
            first = other_since[v, u]
            if other[v, u] < back[v, u]:
                if front_count[v, u] == 0.0:
                    past[v, u], past_seen[v, u], past_gone[v, u] = back[v, u], back_seen[v, u], first
                back[v, u], back_count[v, u], back_seen[v, u] = other[v, u], other_count[v, u], now
                back_sure[v, u] = 0.0
                front_count[v, u] = 0.0
            else:
                if front_count[v, u] > 0.0:
                    back_seen[v, u] = front_seen[v, u]  # until then something else stood here
                front[v, u], front_count[v, u] = other[v, u], other_count[v, u]
                front_since[v, u], front_seen[v, u], flips[v, u] = first, now, 0.0
                before[v, u] = back_count[v, u]
            other_count[v, u], gone[v, u] = 0.0, 0.0


@njit(cache=True, nogil=True)
def _add(mean, count, v, u, reading, near):  # type: ignore[no-untyped-def]
    """Take a raw reading into a mean, unless it is an outlier that smoothing removed."""
    if abs(1.0 / reading - 1.0 / mean[v, u]) < 1.5 * near:
        mean[v, u] += (reading - mean[v, u]) / min(count[v, u] + 1.0, _FORGET)
    count[v, u] += 1.0
