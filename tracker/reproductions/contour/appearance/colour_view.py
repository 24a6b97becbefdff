"""Moments of an image's channels over rectangles of people, by integral images."""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.reproductions.contour.appearance.colour_histograms import BINS, cumulative_histograms
from peopleboy.tracker.reproductions.contour.appearance.regions import (
    PARTS,
    Bounds,
    align,
    aligned,
    alignment,
    covered,
    first_pixel_after,
    part_rectangle,
    part_rectangles,
    pixel_bounds,
)
from peopleboy.tracker.reproductions.contour.colour_config import REPRESENTATIONS, ColourDescriptorConfig
from peopleboy.tracker.reproductions.contour.particles import D, Floats, H, W, X, Y

Integers = NDArray[np.int64]

LEAST_SEEN = 0.5  # least share of a part inside the colour image; otherwise the part is invisible
WHITE = 255.0
_FULL_TURN = 256
# With this many pixels of 255, n S2 and S1^2 still fit an int64.
_MOST_PIXELS = 1 << 23


@dataclass(frozen=True, slots=True, eq=False)
class RegionSums:
    """Power sums over M regions.

    Attributes:
        power: (M, C, K) int64 sum of the k-th powers of each channel, k = 1..K, over the pixels in the image.
        pixels: (M,) int64 their number.
        area: (M,) int64 pixels of the region, including those outside the image.
    """

    power: Integers
    pixels: Integers
    area: Integers

    def __sub__(self, part: "RegionSums") -> "RegionSums":
        """Subtract regions that lie inside these."""
        return RegionSums(self.power - part.power, self.pixels - part.pixels, self.area - part.area)


@dataclass(frozen=True, slots=True, eq=False)
class PowerSums:
    """Integral images of an (H, W, C) picture's first K powers.

    Attributes:
        integral: (H + 1, W + 1, C, K) int64, or int32 for K = 1; entry [v, u] sums over the pixels above
            row v and left of column u. Exact.

    Source: thesis, equations 6.5 to 6.7.
    """

    integral: NDArray[np.integer[Any]]

    @classmethod
    def build(cls, picture: NDArray[np.uint8], degree: int) -> "PowerSums":
        """Make them from a picture (H, W, C) and its powers up to `degree`.

        Raises:
            BadInput: the picture is too large for exact sums.
        """
        if picture.shape[0] * picture.shape[1] > _MOST_PIXELS:
            raise BadInput(f"picture must have at most {_MOST_PIXELS} pixels, got {picture.shape}")
        if degree == 1:
            # OpenCV has no higher powers of integers, but is three times as fast for these.
            height, width, channels = picture.shape
            sums = np.asarray(cv2.integral(picture), dtype=np.int32)
            return cls(sums.reshape(height + 1, width + 1, channels, 1))
        power = np.arange(256, dtype=np.int64) ** np.arange(1, degree + 1, dtype=np.int64)[:, None]
        return cls(_integrate(picture, power))

    def over(self, bounds: Bounds) -> RegionSums:
        """Sum over rectangles (M, 4): first column and row, and those after the last."""
        height, width = self.integral.shape[0] - 1, self.integral.shape[1] - 1
        return RegionSums(_sum_over(self.integral, bounds), *covered(bounds, height, width))


@dataclass(frozen=True, slots=True, eq=False)
class ColourView:
    """A colour image as input of all filters; build it once per frame.

    The colour image only covers the middle of the thermal one. A part of a person with less than `LEAST_SEEN`
    inside it is invisible: its features are NaN, and comparisons ignore them.

    Attributes:
        picture: (H, W, C) uint8 channels of the configured colour space.
        sums: its integral images; None for histograms.
        alignment: (2, 4) from the thermal image to this one.
    """

    picture: NDArray[np.uint8]
    sums: PowerSums | None
    alignment: Floats

    @classmethod
    def build(
        cls, colour: NDArray[np.uint8], thermal_shape: tuple[int, int], config: ColourDescriptorConfig
    ) -> "ColourView":
        """Prepare an RGB image (H, W, 3) that was taken with a thermal image of `thermal_shape`."""
        picture = channels_of(colour, config)
        moments = REPRESENTATIONS[config.representation]
        sums = PowerSums.build(picture, moments) if moments else None
        shape = (colour.shape[0], colour.shape[1])
        return cls(picture, sums, alignment(thermal_shape, shape, config.affine, config.parallax))

    def describe(self, state: Floats) -> Floats:
        """Describe people by the colours of head, torso and legs.

        Args:
            state: (N, 9) contours in the thermal image.

        Returns:
            (N, F) float32, ordered by part, channel, and moment or bin: F = 27 for three moments in RGB.
        """
        return self.describe_rectangles(part_rectangles(state), state[:, H])

    def means(self, state: Floats) -> Floats:
        """Return the mean (N, 3, C), 0..1, of each channel over the parts of people (N, 9); NaN outside."""
        sums = self.sums or PowerSums.build(self.picture, 1)
        means: Floats = _part_means(state, self.alignment, sums.integral, LEAST_SEEN)
        return means

    def describe_rectangles(self, rectangles: Floats, height: Floats, holes: Floats | None = None) -> Floats:
        """Describe regions of people.

        Args:
            rectangles: (N, P, 4) left, top, right, bottom [px], thermal image.
            height: (N,) semi-height h [px] of their people, for the parallax.
            holes: (N, P, 4) rectangles inside of these that are excluded, such as those covered by another
                person.

        Returns:
            (N, F) float32, ordered by rectangle, then channel, then moment or bin.
        """
        bounds = self._bounds(rectangles, height)
        gaps = None if holes is None else _inside(self._bounds(holes, height), bounds)
        if self.sums is None:
            none = np.zeros_like(bounds) if gaps is None else gaps
            described = cumulative_histograms(self.picture, bounds, none, BINS, LEAST_SEEN)
        else:
            sums = self.sums.over(bounds)
            whole = sums if gaps is None else sums - self.sums.over(gaps)
            described = normalised_moments(whole, LEAST_SEEN)
        return described.reshape(len(rectangles), -1)

    def _bounds(self, rectangles: Floats, height: Floats) -> Bounds:
        """Return the pixels (N P, 4) of this image inside thermal rectangles (N, P, 4)."""
        bounds: Bounds = pixel_bounds(aligned(self.alignment, rectangles, height))
        return bounds


def normalised_moments(sums: RegionSums, least_seen: float) -> Floats:
    """Describe M regions by m1 = k1, m2 = k2 / k1 and m3 = k3 / k2^1.5, values scaled to 0..1.

    Undefined moments are 0: m2 of one pixel or of black, m3 of two pixels or of a region of one value. A
    region with less than `least_seen` inside the image, or without a pixel, is NaN.

    Args:
        sums: of C channels and K powers, K = 1..3.
        least_seen: least share of the region's area.

    Returns:
        (M, C, K) float32.

    Source: thesis, equations 6.8 to 6.14.
    """
    moments: Floats = _normalised_moments(sums.power, sums.pixels, sums.area, least_seen)
    return moments


def _inside(part: Bounds, whole: Bounds) -> Bounds:
    """Clip rectangles (M, 4) to others; empty without an intersection."""
    start = np.maximum(part[:, :2], whole[:, :2])
    end = np.maximum(np.minimum(part[:, 2:], whole[:, 2:]), start)
    return np.concatenate([start, end], axis=1)


def channels_of(colour: NDArray[np.uint8], config: ColourDescriptorConfig) -> NDArray[np.uint8]:
    """Convert an RGB image (H, W, 3) to the channels (H, W, C) uint8 of the configured space.

    Hue is an angle, and its mean must not depend on the angle of red: for moments, hue and saturation are a
    position in the colour disc, ((1 + S cos H) / 2, (1 + S sin H) / 2). Histograms use H, S, V unchanged.
    """
    if config.space == "grey":
        return np.asarray(cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY), np.uint8)[..., None]
    if config.space == "rgb":
        return np.ascontiguousarray(colour)
    hsv = np.asarray(cv2.cvtColor(colour, cv2.COLOR_RGB2HSV_FULL), np.uint8)
    return hsv if REPRESENTATIONS[config.representation] == 0 else _disc(hsv)


def _disc(hsv: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Convert hue and saturation to positions in the colour disc, (H, W, 3) in and out."""
    angle = np.arange(_FULL_TURN) * (2 * np.pi / _FULL_TURN)
    hue, saturation = hsv[..., 0], hsv[..., 1].astype(np.float32)
    result = hsv.copy()
    for channel, turn in enumerate((np.cos(angle), np.sin(angle))):
        result[..., channel] = np.rint(127.5 + 0.5 * saturation * turn.astype(np.float32)[hue])
    return result


@njit(cache=True, nogil=True)
def _integrate(picture: NDArray[np.uint8], power: Integers) -> Integers:
    height, width, channels = picture.shape
    result = np.empty((height + 1, width + 1, channels, len(power)), dtype=np.int64)
    result[0] = 0
    for v in range(height):
        result[v + 1, 0] = 0
        for c in range(channels):
            for k in range(len(power)):
                row = np.int64(0)
                for u in range(width):
                    row += power[k, picture[v, u, c]]
                    result[v + 1, u + 1, c, k] = result[v, u + 1, c, k] + row
    return result


@njit(cache=True, nogil=True)
def _sum_over(integral: NDArray[np.integer[Any]], bounds: Bounds) -> Integers:
    height, width, channels, degree = integral.shape
    flat = integral.reshape(height, width, channels * degree)
    power = np.empty((len(bounds), channels * degree), dtype=np.int64)
    for i in range(len(bounds)):
        left, right = min(max(bounds[i, 0], 0), width - 1), min(max(bounds[i, 2], 0), width - 1)
        top, bottom = min(max(bounds[i, 1], 0), height - 1), min(max(bounds[i, 3], 0), height - 1)
        right, bottom = max(left, right), max(top, bottom)
        a, b, c, d = flat[top, left], flat[top, right], flat[bottom, left], flat[bottom, right]
        for j in range(channels * degree):
            power[i, j] = d[j] + a[j] - (b[j] + c[j])
    return power.reshape(len(bounds), channels, degree)


# Without NumPy's rules a kernel would test every division.
@njit(cache=True, nogil=True, error_model="numpy")
def _part_means(
    state: Floats, alignment: Floats, integral: NDArray[np.integer[Any]], least_seen: float
) -> Floats:
    """Return the first moments (N, 3, C) that `_normalised_moments` would, without arrays in between."""
    height, width, channels = integral.shape[0] - 1, integral.shape[1] - 1, integral.shape[2]
    means = np.empty((len(state), PARTS, channels), dtype=np.float32)
    for i in range(len(state)):
        x, y, w, h, d = state[i, X], state[i, Y], state[i, W], state[i, H], state[i, D]
        for part in range(PARTS):
            edges = align(alignment, part_rectangle(x, y, w, h, d, part), h)
            left, top = int(first_pixel_after(edges[0])), int(first_pixel_after(edges[1]))
            right, bottom = int(first_pixel_after(edges[2])), int(first_pixel_after(edges[3]))
            area = max(right - left, 0) * max(bottom - top, 0)
            left, top = min(max(left, 0), width), min(max(top, 0), height)
            right, bottom = max(left, min(right, width)), max(top, min(bottom, height))
            pixels = (right - left) * (bottom - top)
            share = 1.0 / pixels if pixels > 0 and pixels >= least_seen * area else np.nan
            for c in range(channels):
                total = integral[bottom, right, c, 0] + integral[top, left, c, 0]
                total -= integral[top, right, c, 0] + integral[bottom, left, c, 0]
                means[i, part, c] = total * share / WHITE
    return means


# Without NumPy's rules a kernel would test every division.
@njit(cache=True, nogil=True, error_model="numpy")
def _normalised_moments(power: Integers, pixels: Integers, area: Integers, least_seen: float) -> Floats:
    count, channels, degree = power.shape
    result = np.zeros((count, channels, degree), dtype=np.float32)
    for i in range(count):
        n = pixels[i]
        if n == 0 or n < least_seen * area[i]:
            result[i] = np.nan
            continue
        share, pairs, triples = 1.0 / n, 1.0 / (n * (n - 1.0)), n * n / ((n - 1.0) * (n - 2.0))
        for c in range(channels):
            s1 = power[i, c, 0]
            k1 = s1 * share
            result[i, c, 0] = k1 / WHITE
            if degree < 2 or n < 2 or s1 == 0:
                continue
            # In integers, so that a uniform region has exactly no variance.
            spread = n * power[i, c, 1] - s1 * s1
            k2 = spread * pairs
            result[i, c, 1] = k2 / (k1 * WHITE)
            if degree < 3 or n < 3 or spread == 0:
                continue
            # Equation 6.11 with S1 = n k1, divided by n^3 against loss of precision.
            third = 2.0 * k1 * k1 * k1 + share * (power[i, c, 2] - 3.0 * k1 * power[i, c, 1])
            result[i, c, 2] = triples * third / (k2 * np.sqrt(k2))
    return result
