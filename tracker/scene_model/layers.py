"""Per-pixel layers: the background, the object in front of it, and candidates for either."""

from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.scene_model.readings import Readings
from peopleboy.tracker.scene_model.scene import Metres

# Smoothing of surfaces: neighbours on the same plane contribute to a pixel's depth.

_RADIUS_PX: Final = 2


def evened(inverse: Metres, is_sure: NDArray[np.bool_], doubt: Metres) -> Metres:
    """Average inverse depths (H, W) [1/m] with those of neighbours on the same plane.

    Inverse depth is linear in the image on every plane, so that two neighbours on opposite sides of a pixel
    average to its own. Pairs that do not, given their noise, lie across an edge or a fold, and are left out.

    Args:
        inverse: 0 where unknown.
        is_sure: (H, W) which pixels are averaged.
        doubt: (H, W) tolerance of the mean of a pair [1/m].
    """
    return np.asarray(_evened(inverse, is_sure, doubt))


@njit(cache=True, nogil=True)
def _evened(inverse, is_sure, doubt):  # type: ignore[no-untyped-def]
    height, width = inverse.shape
    found = inverse.copy()
    for v in range(height):
        for u in range(width):
            if not is_sure[v, u]:
                continue
            own, near = inverse[v, u], doubt[v, u]
            total, count = own, 1
            for down in range(min(_RADIUS_PX, v, height - 1 - v) + 1):
                reach = min(_RADIUS_PX, u, width - 1 - u)
                for across in range(1 if down == 0 else -reach, reach + 1):
                    one, other = (v - down, u - across), (v + down, u + across)
                    if is_sure[one] and is_sure[other]:
                        pair = 0.5 * (inverse[one] + inverse[other])
                        if abs(pair - own) < near:
                            total, count = total + 2.0 * pair, count + 2
            found[v, u] = total / count
    return found


Bools = NDArray[np.bool_]

NEVER: Final = -1e6
"""[s] Time of an event that never happened."""

# State of each pixel. Background: mean of its readings [1/m], their number, the number of those that agree
# with neighbours, and the time of the last one.
_BACK, _BACK_COUNT, _BACK_SURE, _BACK_SEEN = 0, 1, 2, 3
# Object in front: the same; times of the first and the last reading; number of changes from the background to
# it; number of background readings before.
_FRONT, _FRONT_COUNT, _FRONT_SINCE, _FRONT_SEEN, _FLIPS, _BEFORE = 4, 5, 6, 7, 8, 9
# Consecutive readings that fit neither: the same.
_OTHER, _OTHER_COUNT, _OTHER_SINCE = 10, 11, 12
# Consecutive background readings behind a stored object; kind of the newest reading.
_GONE, _KIND = 13, 14
# Former background in front of a farther one: [1/m], time of the last reading, time of the first farther
# reading.
_PAST, _PAST_SEEN, _PAST_GONE = 15, 16, 17
_ALL = 18
_TIMES = (_BACK_SEEN, _FRONT_SINCE, _FRONT_SEEN, _OTHER_SINCE, _PAST_SEEN, _PAST_GONE)

_IS_BACK, _IS_FRONT, _IS_NEITHER = 0.0, 1.0, 2.0
_FORGET: Final = 3000.0  # number of readings from which a mean follows the newest ones
# Outliers are removed from a mean. A limit in metres alone would bias a noisy one.
_OUTLIER: Final = np.float32(1.5)  # reaches
_OUTLIER_DEVIATIONS: Final = np.float32(3.75)
_FEW, _OFTENER, _FLIPPED = 25.0, 2.0, 3.0
_LEAST: Final = 8.0  # readings of a surface that agree with their neighbours
_SURE: Final = 0.2  # their share
_PLANE_DEVIATIONS: Final = np.float32(2.5)  # of a mean, within which neighbours are on one plane


class Layers:
    """State of every pixel of a standing camera, updated frame by frame.

    Depths are stored inverted, because their noise is then uniform and does not bias a mean of raw readings.

    Args:
        height, width: of the image.
    """

    def __init__(self, height: int, width: int) -> None:
        self._state = np.zeros((_ALL, height, width), np.float32)
        self._state[list(_TIMES)] = NEVER

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width of the image."""
        _, height, width = self._state.shape
        return height, width

    @property
    def background_m(self) -> Metres:
        """(H, W) depth of the background [m]; 0 where there was no reading."""
        return inverted(self._state[_BACK])

    def surface_m(self, noise: Metres) -> Metres:
        """Return (H, W) the background [m], smoothed on planes.

        It is also 0 where light of several surfaces mixes, or readings are rare.

        Args:
            noise: (H, W) standard deviation of a reading of inverse depth [1/m].
        """
        inverse, sure, count = self._state[_BACK], self._state[_BACK_SURE], self._state[_BACK_COUNT]
        is_sure = (sure > _SURE * count) & (sure >= _LEAST)
        doubt = _PLANE_DEVIATIONS * noise / np.sqrt(np.maximum(count, np.float32(1.0)))
        return inverted(np.where(is_sure, evened(inverse, is_sure, doubt), np.float32(0.0)))

    @property
    def is_known(self) -> Bools:
        """(H, W) where there is a background."""
        return np.asarray(self._state[_BACK_COUNT] > 0.0)

    @property
    def is_settled(self) -> Bools:
        """(H, W) where the background has enough readings to be reliable."""
        return np.asarray(self._state[_BACK_COUNT] >= _LEAST)

    @property
    def is_covered(self) -> Bools:
        """(H, W) where an object is in front of the background."""
        return np.asarray(self._state[_FRONT_COUNT] > 0.0)

    @property
    def front_m(self) -> Metres:
        """(H, W) depth of that object [m]; 0 where there is none."""
        return np.where(self.is_covered, inverted(self._state[_FRONT]), np.float32(0.0))

    @property
    def front_since_s(self) -> Metres:
        """(H, W) when that object was first seen [s]."""
        return np.asarray(self._state[_FRONT_SINCE])

    @property
    def front_seen_s(self) -> Metres:
        """(H, W) when that object was last seen [s]."""
        return np.asarray(self._state[_FRONT_SEEN])

    @property
    def back_seen_s(self) -> Metres:
        """(H, W) when the background was last seen [s]."""
        return np.asarray(self._state[_BACK_SEEN])

    @property
    def past_m(self) -> Metres:
        """(H, W) depth of the former background in front of a farther one [m]; 0 for none."""
        return inverted(self._state[_PAST])

    @property
    def past_seen_s(self) -> Metres:
        """(H, W) when the former background was last seen [s]."""
        return np.asarray(self._state[_PAST_SEEN])

    @property
    def past_gone_s(self) -> Metres:
        """(H, W) when the farther background was first seen [s]."""
        return np.asarray(self._state[_PAST_GONE])

    def is_before(self, smooth_m: Metres, least_m: Metres) -> Bools:
        """(H, W) where a reading fits no layer, and is this much nearer than the background [m]."""
        state = self._state
        return np.asarray((state[_KIND] == _IS_NEITHER) & (self.background_m - smooth_m > least_m))

    def is_opened(self, time_s: float) -> Bools:
        """(H, W) where a farther surface became the background in the frame of a given time [s]."""
        state = self._state
        return np.asarray((state[_BACK_SEEN] == np.float32(time_s)) & (state[_KIND] == _IS_NEITHER))

    def take_in(
        self, readings: Readings, reach_m: Metres, ignored: Bools, time_s: float, confirm: int
    ) -> None:
        """Assign the readings of a frame to layers.

        A reading that fits neither background nor object is accepted after several consecutive ones agree: it
        becomes the background if it is farther, and an object if it is nearer. Layers behind people are kept.
        Smoothed readings are assigned, and raw ones are averaged.

        Args:
            readings: of the frame.
            reach_m: (H, W) tolerance of two readings [m].
            ignored: (H, W) where people are.
            time_s: of the frame.
            confirm: number of consecutive readings needed.
        """
        raw, smooth, mixed = readings.raw_m, readings.smooth_m, readings.is_mixed
        wide = np.maximum(_OUTLIER * reach_m, _OUTLIER_DEVIATIONS * readings.noise * smooth**2)
        now, enough = np.float32(time_s), np.float32(confirm)
        _sort(self._state, raw, smooth, mixed, reach_m, wide, ignored, now, enough)


def inverted(values: Metres) -> Metres:
    """Convert depths [m] to inverse depths and back; 0 stays 0."""
    return np.asarray(np.divide(1.0, values, out=np.zeros_like(values), where=values > 0.0), np.float32)


@njit(cache=True, nogil=True)
def _sort(state, raw, smooth, mixed, reach, wide, ignored, now, confirm):  # type: ignore[no-untyped-def]
    height, width = raw.shape
    for v in range(height):
        for u in range(width):
            if smooth[v, u] > 0.0 and not ignored[v, u]:
                near, far = reach[v, u], wide[v, u]
                _take(state, v, u, raw[v, u], smooth[v, u], mixed[v, u], near, far, now, confirm)


@njit(cache=True, nogil=True)
def _take(state, v, u, raw, z, is_mixed, near, wide, now, confirm):  # type: ignore[no-untyped-def]
    reading = 1.0 / raw
    if state[_BACK_COUNT, v, u] == 0.0:
        state[_BACK, v, u], state[_BACK_COUNT, v, u], state[_BACK_SEEN, v, u] = reading, 1.0, now
        return
    if state[_FRONT_COUNT, v, u] > 0.0 and abs(z - 1.0 / state[_FRONT, v, u]) < near:
        _see_front(state, v, u, z, reading, near, wide, now)
    elif abs(z - 1.0 / state[_BACK, v, u]) < near:
        _see_back(state, v, u, reading, is_mixed, wide, now, confirm)
    else:
        _see_other(state, v, u, z, reading, near, wide, now)
        if state[_OTHER_COUNT, v, u] >= confirm:
            _believe(state, v, u, now)


@njit(cache=True, nogil=True)
def _see_front(state, v, u, z, reading, near, wide, now):  # type: ignore[no-untyped-def]
    """Update the object layer; initial background may have been an outlier, or the far side of an edge."""
    _add(state, _FRONT, v, u, reading, wide)
    state[_FLIPS, v, u] += state[_KIND, v, u] == _IS_BACK
    state[_FRONT_SEEN, v, u], state[_GONE, v, u], state[_OTHER_COUNT, v, u] = now, 0.0, 0.0
    state[_KIND, v, u] = _IS_FRONT
    is_oftener = state[_FRONT_COUNT, v, u] > _OFTENER * state[_BACK_COUNT, v, u]
    is_close = 1.0 / state[_BACK, v, u] - z < 2.0 * near
    if is_oftener and state[_BEFORE, v, u] < _FEW and (is_close or state[_FLIPS, v, u] >= _FLIPPED):
        state[_BACK, v, u], state[_BACK_SEEN, v, u] = state[_FRONT, v, u], now
        state[_BACK_COUNT, v, u] = state[_BACK_SURE, v, u] = state[_FRONT_COUNT, v, u]
        state[_FRONT_COUNT, v, u] = 0.0


@njit(cache=True, nogil=True)
def _see_back(state, v, u, reading, is_mixed, wide, now, confirm):  # type: ignore[no-untyped-def]
    """Update the background; a stored object in front is removed after several consecutive readings."""
    _add(state, _BACK, v, u, reading, wide)
    state[_BACK_SURE, v, u] += not is_mixed
    state[_KIND, v, u], state[_OTHER_COUNT, v, u] = _IS_BACK, 0.0
    state[_GONE, v, u] += 1.0
    if state[_FRONT_COUNT, v, u] == 0.0 or state[_GONE, v, u] >= confirm:
        state[_BACK_SEEN, v, u], state[_FRONT_COUNT, v, u], state[_GONE, v, u] = now, 0.0, 0.0


@njit(cache=True, nogil=True)
def _see_other(state, v, u, z, reading, near, wide, now):  # type: ignore[no-untyped-def]
    state[_KIND, v, u] = _IS_NEITHER
    if state[_OTHER_COUNT, v, u] > 0.0 and abs(z - 1.0 / state[_OTHER, v, u]) < near:
        _add(state, _OTHER, v, u, reading, wide)
    else:
        state[_OTHER, v, u], state[_OTHER_COUNT, v, u], state[_OTHER_SINCE, v, u] = reading, 1.0, now


@njit(cache=True, nogil=True)
def _believe(state, v, u, now):  # type: ignore[no-untyped-def]
    """Make an accepted reading the background if it is farther, or an object if it is nearer."""
    first = state[_OTHER_SINCE, v, u]
    if state[_OTHER, v, u] < state[_BACK, v, u]:
        if state[_FRONT_COUNT, v, u] == 0.0:
            state[_PAST, v, u], state[_PAST_SEEN, v, u] = state[_BACK, v, u], state[_BACK_SEEN, v, u]
            state[_PAST_GONE, v, u] = first
        state[_BACK, v, u], state[_BACK_COUNT, v, u] = state[_OTHER, v, u], state[_OTHER_COUNT, v, u]
        state[_BACK_SEEN, v, u], state[_BACK_SURE, v, u], state[_FRONT_COUNT, v, u] = now, 0.0, 0.0
    else:
        if state[_FRONT_COUNT, v, u] > 0.0:
            state[_BACK_SEEN, v, u] = state[_FRONT_SEEN, v, u]  # until then another surface was here
        state[_FRONT, v, u], state[_FRONT_COUNT, v, u] = state[_OTHER, v, u], state[_OTHER_COUNT, v, u]
        state[_FRONT_SINCE, v, u], state[_FRONT_SEEN, v, u], state[_FLIPS, v, u] = first, now, 0.0
        state[_BEFORE, v, u] = state[_BACK_COUNT, v, u]
    state[_OTHER_COUNT, v, u], state[_GONE, v, u] = 0.0, 0.0


@njit(cache=True, nogil=True)
def _add(state, mean, v, u, reading, wide):  # type: ignore[no-untyped-def]
    """Add a raw reading to a mean, whose number of readings is stored next to it."""
    count = mean + 1
    if abs(1.0 / reading - 1.0 / state[mean, v, u]) < wide:
        state[mean, v, u] += (reading - state[mean, v, u]) / min(state[count, v, u] + 1.0, _FORGET)
    state[count, v, u] += 1.0
