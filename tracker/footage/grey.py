"""Conversion of thermal pictures to the tracker's input: (H, W) uint8, brighter for warmer."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from typing import Annotated, Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.settings import Metavar
from peopleboy.tracker.footage.read_tiff import Raw

# For trackers that use contrast alone, each pixel is expressed in standard deviations of its neighbourhood.

Values = NDArray[np.float32]

AROUND: Final = 0.4
"""Standard deviation of the Gaussian neighbourhood, in heights of the picture."""

GREYS: Final = 50.0
"""Greys per standard deviation."""

NOISE: Final = 20.0
"""Least standard deviation in standard deviations of the noise, so that a plain wall stays plain."""

LEAST: Final = 0.01
"""The same in spans of the whole picture, as coarsely quantised pictures seem noiseless."""

OUTLIERS: Final = 0.05
"""Share of clipped pixels, such as lamps and heaters."""

COARSE_PX: Final = 24.0
"""Standard deviation of the neighbourhood in a reduced picture, in which it is computed."""

_MIDDLE: Final = 128.0
"""Grey of the mean of the neighbourhood."""

SAMPLED_ROWS: Final = 170
"""Least number of rows, evenly spread, whose pixels enter the statistics of the whole picture."""


def local_grey(values: Values) -> "Grey":
    """Normalise each pixel by mean and standard deviation of its neighbourhood.

    Small contrasts stay visible even if a lamp in the picture is far hotter, which a single gain for the
    whole picture cannot achieve. Greys do not depend on the unit or the temperature.

    Args:
        values: (H, W) in any unit; warmer is larger.

    Returns:
        (H, W), `_MIDDLE` for the mean of the neighbourhood.
    """
    every = max(values.shape[0] // SAMPLED_ROWS, 1)
    few = values[::every, ::every]
    away = values - np.float32(np.median(few))  # so that rounding does not grow with the offset
    away -= _around(away)
    square = np.square(away)
    most = np.percentile(square[::every, ::every], 100.0 * (1.0 - OUTLIERS))
    np.minimum(square, np.float32(most), out=square)
    deviation = np.sqrt(_around(square))
    np.maximum(deviation, np.float32(_least_deviation(values[::every], few)), out=deviation)
    return _whole_grey(np.asarray(_MIDDLE + GREYS * away / deviation, np.float32))


def fill_outside(values: Values, mask: NDArray[np.bool_]) -> Values:
    """Replace values (H, W) outside a mask (H, W) by the mean of those inside, in the neighbourhood."""
    inside = mask.astype(np.float32)
    offset = np.float32(np.mean(values[mask]))
    mean = _around((values - offset) * inside) / np.maximum(_around(inside), np.float32(1e-3)) + offset
    return np.where(mask, values, mean)


def noise_of(values: Values) -> float:
    """Return the standard deviation of the noise of a picture (H, W), from second differences along rows."""
    bend = values[:, 2:] + values[:, :-2] - 2.0 * values[:, 1:-1]
    return float(np.median(np.abs(bend)) / 0.6745 / np.sqrt(6.0))


def _least_deviation(rows: Values, few: Values) -> float:
    """Return the least standard deviation of a neighbourhood, from some rows, and from a sample of them."""
    low, high = np.percentile(few, [1, 99])
    return max(NOISE * noise_of(rows), LEAST * float(high - low), 1e-6)


def _around(values: Values) -> Values:
    """Return the Gaussian mean about each pixel (H, W), which is so smooth that a reduced picture has it."""
    rows, columns = values.shape
    sigma_px = AROUND * rows
    by = max(sigma_px / COARSE_PX, 1.0)
    size = max(round(columns / by), 1), max(round(rows / by), 1)
    mean = cv2.GaussianBlur(cv2.resize(values, size, interpolation=cv2.INTER_AREA), (0, 0), sigma_px / by)
    return np.asarray(cv2.resize(mean, (columns, rows)), np.float32)


Grey = NDArray[np.uint8]

ROBOT_SPAN_C: Final = (24.0, 36.0)  # of the robot's own thermal camera (thesis, chapter 3)
CENTIKELVIN: Final = (0.01, -273.15)
CLUTTER_GREY: Final = 11.0
MEMORY_FRAMES: Final = 30
NOISE_SPAN: Final = 40.0  # least span in standard deviations of the noise
LEAST_SIDE_PX: Final = 24
_SWAPPED: Final = 8.0  # ratio of the mean steps between neighbours from which bytes are exchanged


class Polarity(StrEnum):
    """Grey of warm objects."""

    WHITE_HOT = "white-hot"
    BLACK_HOT = "black-hot"


@dataclass(frozen=True, slots=True, kw_only=True)
class Radiometry:
    """Conversion of pixels to degC, if known.

    Attributes:
        scale: gain and offset of counts to degC; None if unknown.
    """

    span_c: Annotated[
        tuple[float, float] | None,
        Field(
            alias="temperature_range",
            description="Temperatures [degC] of grey levels 0 and 255 in 8-bit images.",
        ),
        Metavar("LOW HIGH"),
    ] = None
    scale: tuple[float, float] | None = None
    polarity: Annotated[
        Polarity | None,
        Field(
            description="Whether warm pixels are bright (white-hot) or dark (black-hot).  [default: detected "
            "in recorded 8-bit images, otherwise white-hot]"
        ),
    ] = None

    def __post_init__(self) -> None:
        if self.span_c is not None and self.scale is not None:
            raise BadInput("--temperature-range is for 8-bit pictures and --scale for 16-bit ones; give one")
        if self.span_c is not None and not self.span_c[0] < self.span_c[1]:
            raise BadInput(f"--temperature-range must be LOW < HIGH, got {self.span_c[0]} {self.span_c[1]}")
        if self.scale is not None and not (np.isfinite(self.scale).all() and self.scale[0] > 0):
            raise BadInput(f"--scale must be a positive gain and an offset, got {self.scale}")
        if self.scale is not None and self.polarity is Polarity.BLACK_HOT:
            raise BadInput(
                "--polarity black-hot is for grey; counts that --scale reads grow with temperature, "
                "leave one out"
            )

    @property
    def is_known(self) -> bool:
        """Whether degC are known."""
        return self.span_c is not None or self.scale is not None

    def values(self, flat: Raw) -> NDArray[np.float32]:
        """Return the values of pixels (H, W): degC if known, else grey or counts; warmer is always larger.

        Raises:
            BadInput: the picture's bit depth does not match the given option.
        """
        is_eight_bit = flat.dtype == np.uint8
        if self.span_c is not None and not is_eight_bit:
            raise BadInput(f"--temperature-range is for 8-bit pictures, got {flat.dtype}; give --scale")
        if self.scale is not None and is_eight_bit:
            raise BadInput(
                "--scale is for 16-bit or float pictures, got 8-bit ones; give --temperature-range"
            )
        values = flat.astype(np.float32)
        if self.polarity is Polarity.BLACK_HOT:
            values = (255.0 if is_eight_bit else 65535.0 if flat.dtype == np.uint16 else 0.0) - values
        gain, offset = self._line()
        return values * np.float32(gain) + np.float32(offset)

    def _line(self) -> tuple[float, float]:
        if self.span_c is not None:
            low, high = self.span_c
            return (high - low) / 255.0, low
        return (1.0, 0.0) if self.scale is None else self.scale


def parse_scale(text: str) -> tuple[float, float]:
    """Parse `centikelvin`, or `GAIN,OFFSET`.

    Raises:
        BadInput: it is neither.
    """
    if text == "centikelvin":
        return CENTIKELVIN
    try:
        gain, offset = (float(part) for part in text.split(","))
    except ValueError:
        raise BadInput(
            f"--scale must be 'centikelvin' or GAIN,OFFSET with degC = GAIN counts + OFFSET, got {text!r}"
        ) from None
    return gain, offset


def spanned(values: NDArray[np.float32], span: tuple[float, float] = ROBOT_SPAN_C) -> Grey:
    """Scale values (H, W) to greys over a span, by default degC of the robot's own camera."""
    low, high = span
    return _whole_grey((values - np.float32(low)) * np.float32(255.0 / (high - low)))


def _whole_grey(grey: NDArray[np.float32]) -> Grey:
    return np.asarray(np.clip(np.rint(grey), 0, 255), dtype=np.uint8)


def are_bytes_swapped(counts: NDArray[Any]) -> bool:
    """Return whether neighbours in 16-bit counts (H, W) are far more alike with the bytes of each exchanged.

    Some cameras' PNG files have the bytes in the wrong order.
    """
    if counts.dtype != np.uint16 or counts.ndim != 2:
        return False
    if min(int(np.ptp(counts & 0xFF)), int(np.ptp(counts >> 8))) == 0:
        return False

    def step(values: NDArray[Any]) -> float:
        return float(np.abs(np.diff(values.astype(np.int32), axis=1)).mean())

    return step(counts) > _SWAPPED * step(counts.byteswap())


class AutomaticGrey:
    """Scales pictures to the contrast that the tracker expects.

    The scene's span fills the grey scale, unless its clutter would then be as strong as people are: the
    contrast of neighbouring positions that is above `CLUTTER_GREY` in a third of them. A span of pure noise
    is not stretched either. Measurements are low-passed over the pictures so far, so that the grey of an
    object changes slowly.
    """

    def __init__(self) -> None:
        self._measured: NDArray[np.float64] | None = None

    def __call__(self, values: NDArray[np.float32]) -> Grey:
        """Convert values (H, W) in any unit to grey."""
        now = _measure(values)
        before = now if self._measured is None else self._measured
        self._measured = before + (now - before) / MEMORY_FRAMES
        low, high, clutter, noise = self._measured
        span = max(high - low, NOISE_SPAN * noise, 255.0 / CLUTTER_GREY * clutter, 1e-6)
        grey = 127.5 + (values - np.float32((low + high) / 2)) * np.float32(255.0 / span)
        return _whole_grey(grey)


def _measure(values: NDArray[np.float32]) -> NDArray[np.float64]:
    """Measure low and high, clutter and noise of a picture (H, W), robust to a few bright pixels."""
    few = values[::2, ::2]
    away = max(few.shape[0] // 40, 1)
    across, down = few[:, 2 * away :] - few[:, : -2 * away], few[2 * away :] - few[: -2 * away]
    clutter = np.percentile(np.abs(np.concatenate([across.ravel(), down.ravel()])), 70)
    low, high = np.percentile(few, [1, 99])
    return np.array([low, high, clutter, noise_of(values)], dtype=np.float64)


def grey_maker(
    radiometry: Radiometry, *, is_grey: bool, by_contrast: bool
) -> Callable[[NDArray[np.float32]], Grey]:
    """Return the conversion of values to grey.

    Args:
        radiometry: known properties of the pixels.
        is_grey: whether the pictures have 8 bits.
        by_contrast: whether the tracker only uses contrast; it then gets 8-bit pictures unchanged.
    """
    if by_contrast:
        return partial(spanned, span=radiometry.span_c or (0.0, 255.0)) if is_grey else local_grey
    return spanned if radiometry.is_known else AutomaticGrey()


# Implausible temperatures indicate a wrong scale, which would silently ruin the tracking.

PLAUSIBLE_C: Final = (-100.0, 200.0)
"""Range of the median: no camera sees a colder sky, and nobody stands in a hotter place."""

_ZERO_K_C: Final = CENTIKELVIN[1]
_COUNTS_PER_K: Final = (100, 25, 10, 1)  # units in which cameras write kelvin


def check_plausible(radiometry: Radiometry, values: NDArray[np.float32]) -> None:
    """Refuse implausible temperatures, such as those of pixels in another unit.

    The median is used, so that dead pixels and empty borders have no effect.

    Args:
        radiometry: known properties of the pixels.
        values: (H, W) converted values; degC if they are known.

    Raises:
        BadInput: the median is colder or hotter than `PLAUSIBLE_C`.
    """
    if not radiometry.is_known or _is_plausible(values):
        return
    low, high = PLAUSIBLE_C
    raise BadInput(
        f"{_option(radiometry)}: pictures then hold {values.min():.0f}..{values.max():.0f} degC, and half of "
        f"each should be within {low:.0f}..{high:.0f}; {_advice(radiometry, values)}"
    )


def _is_plausible(values_c: NDArray[np.float32]) -> bool:
    low, high = PLAUSIBLE_C
    return low <= float(np.median(values_c)) <= high


def _option(radiometry: Radiometry) -> str:
    if radiometry.scale is not None:
        return "--scale {:g},{:g}".format(*radiometry.scale)
    return "--temperature-range {:g} {:g}".format(*(radiometry.span_c or ()))


def _advice(radiometry: Radiometry, values: NDArray[np.float32]) -> str:
    """Return the option that would make these values (H, W) plausible."""
    if radiometry.scale is None:
        return "is it kelvin? give degC" if _is_plausible(values + np.float32(_ZERO_K_C)) else "give degC"
    gain, offset = radiometry.scale
    counts = (values - np.float32(offset)) / np.float32(gain)
    for per_k in _COUNTS_PER_K:
        if _is_plausible(counts / np.float32(per_k) + np.float32(_ZERO_K_C)):
            scale = "centikelvin" if per_k == 100 else f"{1 / per_k:g},{_ZERO_K_C:g}"
            return f"is it --scale {scale}?"
    return "degC must be GAIN counts + OFFSET; without --scale, grey follows the scene's contrast"
