"""Camera electronics: the mapping from temperatures to grey.

An automatic gain depends on the histogram of the image. The histogram's tails define the span; a linear gain
maps the span to greys, and plateau equalisation gives frequent temperatures more greys, limited by a plateau.
Greys 0 and 255 are reserved for the tails.
"""

import math
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.camera_config import ThermalConfig
from peopleboy.sim.cameras.imaging.blur import optics_blur

Temperatures = NDArray[np.float32]
Grey = NDArray[np.uint8]
Bins = NDArray[np.float64]

COLDEST_C: Final = -60.0
BIN_K: Final = 0.05
BINS: Final = 4800
"""Bins of the histogram, from `COLDEST_C` up; the first and last include colder and hotter values."""

_BLACK, _WHITE = 1.0, 254.0  # greys of the span's ends, so that neither counts as clipped
_EDGES = COLDEST_C + BIN_K * np.arange(BINS)
_CHUNK = 640  # pixels that are looked up together, for vectorisation


def encode_8bit(temperature_c: Temperatures, lowest_c: float = 24.0, highest_c: float = 36.0) -> Grey:
    """Encode [degC] as grey: round((T - lowest) / (highest - lowest) * 255), clipped (T ch. 3)."""
    grey = (temperature_c - np.float32(lowest_c)) * np.float32(255.0 / (highest_c - lowest_c))
    return np.asarray(np.clip(np.rint(grey), 0.0, 255.0), np.uint8)


class Gain:
    """Converts successive images to grey; an automatic gain adapts over time.

    Args:
        config: kind of gain, and its settings.
    """

    def __init__(self, config: ThermalConfig) -> None:
        self._config = config
        self._shares: Bins | None = None
        self._span_c = (0.0, 0.0)
        self._time_s = 0.0

    def grey(self, temperature_c: Temperatures, time_s: float) -> Grey:
        """Encode an (H, W) image [degC] that was taken at a time [s], not before the last one."""
        config = self._config
        if config.gain == "fixed":
            return encode_8bit(temperature_c, config.lowest_c, config.highest_c)
        self._follow(histogram(temperature_c), time_s)
        low_c, high_c = self._span_c
        if config.gain == "percentile" or self._shares is None:
            return linear(temperature_c, *at_least(low_c, high_c, config.least_span_k))
        rise = equalised(
            self._shares,
            low_c,
            high_c,
            config.plateau_percent / 100.0,
            config.linear_share,
            config.least_span_k,
        )
        return apply(temperature_c, grey_curve(rise))

    def _follow(self, shares: Bins, time_s: float) -> None:
        """Update the span by an image's histogram: it grows at once, and shrinks with the time constant."""
        low_c, high_c = span_of(shares, self._config.tail_percent / 100.0)
        if self._shares is not None:
            part = _part(time_s - self._time_s, self._config.gain_follows_s)
            before_low, before_high = self._span_c
            low_c = min(low_c, before_low + part * (low_c - before_low))
            high_c = max(high_c, before_high + part * (high_c - before_high))
            shares = self._shares + part * (shares - self._shares)
        self._shares, self._span_c, self._time_s = shares, (low_c, high_c), time_s


def histogram(temperature_c: Temperatures) -> Bins:
    """Count an image [degC] into (`BINS`,) shares, which sum to 1."""
    return _count(temperature_c.reshape(-1)) / temperature_c.size


def span_of(shares: Bins, tail: float) -> tuple[float, float]:
    """Return the span [degC] outside which lies at most a share `tail` at either end, to whole bins."""
    below = np.cumsum(shares)
    first = int(np.searchsorted(below, tail, side="right"))
    last = int(np.searchsorted(below, below[-1] - tail, side="left"))
    return COLDEST_C + BIN_K * min(first, BINS - 1), COLDEST_C + BIN_K * (min(last, BINS - 1) + 1)


def at_least(low_c: float, high_c: float, least_k: float) -> tuple[float, float]:
    """Widen a span about its middle to a minimum width [K]."""
    more = max(least_k - (high_c - low_c), 0.0) / 2.0
    return low_c - more, high_c + more


def linear(temperature_c: Temperatures, low_c: float, high_c: float) -> Grey:
    """Encode a span [degC] linearly as greys 1..254; 0 and 255 are for values outside."""
    edge = (high_c - low_c) / (_WHITE - _BLACK)
    return encode_8bit(temperature_c, low_c - edge, high_c + edge)


def equalised(
    shares: Bins, low_c: float, high_c: float, plateau: float, linear_share: float, least_k: float
) -> Bins:
    """Return the rise of grey over each bin, as shares of all greys: plateau equalisation.

    The weight of a bin is limited to the plateau, and 0 outside the span. The slope is limited to that of a
    span of `least_k`; the sum is therefore 1 or less.

    Args:
        shares: (BINS,) shares of the image's pixels.
        low_c: [degC] lower end of the span.
        high_c: [degC] upper end of the span.
        plateau: largest share of a bin.
        linear_share: share of the greys that is distributed evenly over the span.
        least_k: [K] span that limits the slope.
    """
    first = int(np.searchsorted(_EDGES, low_c - BIN_K / 2.0, side="right"))
    last = int(np.searchsorted(_EDGES, high_c - BIN_K / 2.0, side="left"))
    counted, rise = np.zeros(BINS), np.zeros(BINS)
    np.minimum(shares[first:last], plateau, out=counted[first:last])
    total, evenly = counted.sum(), 1.0 / (last - first)
    by_count = counted[first:last] / total if total > 0.0 else evenly
    rise[first:last] = np.minimum(linear_share * evenly + (1.0 - linear_share) * by_count, BIN_K / least_k)
    return rise


def grey_curve(rise: Bins) -> Bins:
    """Return the grey at the (BINS + 1,) ends of bins, 1..254; unused greys are split between both ends."""
    curve = np.zeros(BINS + 1)
    np.cumsum(rise, out=curve[1:])
    curve += (1.0 - curve[-1]) / 2.0
    curve *= _WHITE - _BLACK
    curve += _BLACK
    return curve


def apply(temperature_c: Temperatures, curve: Bins) -> Grey:
    """Look up the greys of an (H, W) image [degC] in a curve, by linear interpolation."""
    return _look_up(temperature_c.reshape(-1), curve.astype(np.float32)).reshape(temperature_c.shape)


def _part(passed_s: float, follows_s: float) -> float:
    """Return the share of the step to a new value after some time; 1 without a time constant."""
    return 1.0 - math.exp(-passed_s / follows_s) if follows_s > 0.0 else 1.0


@njit(cache=True)
def _count(temperature_c: Temperatures) -> Bins:
    # Neighbours often share a bin: two rows of counts avoid waiting for the previous write.
    even, odd = np.zeros(BINS, np.int32), np.zeros(BINS, np.int32)
    pixels, places = len(temperature_c), np.empty(_CHUNK, np.uint16)
    for first in range(0, pixels, _CHUNK):
        end = min(_CHUNK, pixels - first)
        for i in range(end):
            place = (temperature_c[first + i] - COLDEST_C) / BIN_K
            places[i] = np.uint16(np.int32(min(max(place, 0.0), BINS - 1.0)))
        for i in range(0, end - 1, 2):
            even[places[i]] += 1
            odd[places[i + 1]] += 1
        if end % 2 == 1:
            even[places[end - 1]] += 1
    return (even + odd).astype(np.float64)


@njit(cache=True)
def _look_up(temperature_c: Temperatures, curve: NDArray[np.float32]) -> Grey:
    pixels, one = len(temperature_c), np.uint32(1)
    grey, places, share = np.empty(pixels, np.uint8), np.empty(_CHUNK, np.uint32), np.empty(_CHUNK)
    low, high = np.empty(_CHUNK, np.float32), np.empty(_CHUNK, np.float32)
    for first in range(0, pixels, _CHUNK):
        end = min(_CHUNK, pixels - first)
        for i in range(end):
            place = min(max((temperature_c[first + i] - COLDEST_C) / BIN_K, 0.0), BINS - 1e-3)
            k = np.int32(place)
            places[i], share[i] = k, place - k
        for i in range(end):
            low[i], high[i] = curve[places[i]], curve[places[i] + one]
        for i in range(end):
            grey[first + i] = np.uint8(np.int32(low[i] + share[i] * (high[i] - low[i]) + 0.5))
    return grey


# Display of a thermal image: the whole scene, independent of the camera's gain.

_TAIL: Final = 0.002
_PLATEAU: Final = 0.004
_LINEAR_SHARE: Final = 0.5
_LEAST_K: Final = 5.0


def show_scene(temperature_c: Temperatures) -> Grey:
    """Return the greys of an (H, W) image [degC], independent of earlier images; none is clipped."""
    shares = histogram(temperature_c)
    rise = equalised(shares, *span_of(shares, _TAIL), _PLATEAU, _LINEAR_SHARE, _LEAST_K)
    return apply(temperature_c, grey_curve(rise))


# Enhancement of thermal images: sharpened details before the gain, JPEG compression after it.

MOST_K: Final = 2.0
"""[K] largest change of a pixel by sharpening; otherwise a lamp would blacken its surroundings."""


def sharpen(
    temperature_c: NDArray[np.float32], amount: float, radius_px: float, coring_k: float = 0.0
) -> NDArray[np.float32]:
    """Sharpen an (H, W) image by unsharp masking: add its difference from a blurred copy, times an amount.

    This leaves halos at edges, dark on the cold side and bright on the warm one. With coring, smaller
    differences are treated as noise and replaced by the blurred image; twice as large ones are kept. The
    digital detail filters of uncooled cameras work like this: walls are smooth, and edges are crisp.

    Args:
        temperature_c: (H, W) [degC].
        amount: amount of the mask.
        radius_px: [px] standard deviation of the blur.
        coring_k: [K] threshold of coring.
    """
    if (amount <= 0.0 and coring_k <= 0.0) or radius_px <= 0.0:
        return temperature_c
    crisp = optics_blur(temperature_c, radius_px)
    values, blurred, most = temperature_c.reshape(-1), crisp.reshape(-1), np.float32(MOST_K)
    if coring_k > 0.0:
        _keep_detail(values, np.float32(amount), np.float32(coring_k), most, blurred)
    else:
        _add_detail(values, np.float32(amount), most, blurred)
    return crisp


@njit(cache=True, fastmath=True)
def _add_detail(
    values: NDArray[np.float32], amount: np.float32, most: np.float32, blurred: NDArray[np.float32]
) -> None:
    """Replace blurred values (N,) by sharpened ones."""
    for i in range(len(values)):
        detail = amount * (values[i] - blurred[i])
        blurred[i] = values[i] + min(max(detail, -most), most)


@njit(cache=True, fastmath=True)
def _keep_detail(
    values: NDArray[np.float32],
    amount: np.float32,
    coring: np.float32,
    most: np.float32,
    blurred: NDArray[np.float32],
) -> None:
    """Replace blurred values (N,) by sharpened ones, except for small differences."""
    none, one = np.float32(0.0), np.float32(1.0)
    steeper = one / coring
    for i in range(len(values)):
        apart = values[i] - blurred[i]
        kept = min(max(abs(apart) * steeper - one, none), one)
        change = apart * (kept * (one + amount) - one)
        blurred[i] = values[i] + min(max(change, -most), most)


def compress(grey: NDArray[np.uint8], quality: int | None) -> NDArray[np.uint8]:
    """Compress an (H, W) image as JPEG with a quality of 1..100 and decode it; None leaves it unchanged."""
    if quality is None:
        return grey
    packed = cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return np.asarray(cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE), np.uint8)
