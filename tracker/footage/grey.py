"""What a thermal picture of any kind looks like to the tracker: (H, W) uint8, warm bright."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.local_grey import local_grey, noise_of
from peopleboy.tracker.footage.read_picture import Raw

Grey = NDArray[np.uint8]

ROBOT_SPAN_C: Final = (24.0, 36.0)  # that of the robot's own thermal camera (thesis, chapter 3)
CENTIKELVIN: Final = (0.01, -273.15)
CLUTTER_GREY: Final = 11.0
MEMORY_FRAMES: Final = 30
NOISE_SPAN: Final = 40.0  # standard deviations of the noise in the least span
LEAST_SIDE_PX: Final = 24
_ALIKE: Final = 12  # grey by which channels of a grey picture differ at most, after a lossy codec


@dataclass(frozen=True, slots=True, kw_only=True)
class Radiometry:
    """How pixels become degC, as far as anybody knows.

    Attributes:
        span_c: degC that 0 and 255 of 8-bit pictures stand for; None if unknown.
        scale: gain and offset of counts to degC; None if unknown.
        is_inverted: whether cold is bright.
    """

    span_c: tuple[float, float] | None = None
    scale: tuple[float, float] | None = None
    is_inverted: bool = False

    def __post_init__(self) -> None:
        if self.span_c is not None and self.scale is not None:
            raise BadInput("--temperature-range is for 8-bit pictures and --scale for 16-bit ones; give one")
        if self.span_c is not None and not self.span_c[0] < self.span_c[1]:
            raise BadInput(f"--temperature-range must be LOW < HIGH, got {self.span_c[0]} {self.span_c[1]}")
        if self.scale is not None and not (np.isfinite(self.scale).all() and self.scale[0] > 0):
            raise BadInput(f"--scale must be a positive gain and an offset, got {self.scale}")
        if self.scale is not None and self.is_inverted:
            raise BadInput(
                "--black-hot is for grey; counts that --scale reads grow with temperature, leave one out"
            )

    @property
    def is_known(self) -> bool:
        """Whether degC are known."""
        return self.span_c is not None or self.scale is not None

    def values(self, picture: Raw, notes: list[str]) -> NDArray[np.float32]:
        """Give what pixels (H, W) stand for: degC if known, else grey or counts; warm is always more.

        Raises:
            BadInput: the picture's depth is not that of the option given.
        """
        flat = one_channel(picture, notes)
        is_eight_bit = flat.dtype == np.uint8
        if self.span_c is not None and not is_eight_bit:
            raise BadInput(f"--temperature-range is for 8-bit pictures, got {flat.dtype}; give --scale")
        if self.scale is not None and is_eight_bit:
            raise BadInput(
                "--scale is for 16-bit or float pictures, got 8-bit ones; give --temperature-range"
            )
        values = flat.astype(np.float32)
        if self.is_inverted:
            values = (255.0 if is_eight_bit else 65535.0 if flat.dtype == np.uint16 else 0.0) - values
        gain, offset = self._line()
        return values * np.float32(gain) + np.float32(offset)

    def _line(self) -> tuple[float, float]:
        if self.span_c is not None:
            low, high = self.span_c
            return (high - low) / 255.0, low
        return (1.0, 0.0) if self.scale is None else self.scale


def parse_scale(text: str) -> tuple[float, float]:
    """Read `centikelvin`, or `GAIN,OFFSET`.

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


def one_channel(picture: Raw, notes: list[str]) -> NDArray[Any]:
    """Turn a picture (H, W) or (H, W, 3) into (H, W); false colours become as bright as they look."""
    if picture.ndim == 2:
        return picture
    if int(np.ptp(picture[::4, ::4].astype(np.int16), axis=2).max()) > _ALIKE:
        text = "pictures are coloured and were turned to grey; false colours need not keep warm above cold"
        if text not in notes:
            notes.append(text)
    return np.asarray(cv2.cvtColor(np.ascontiguousarray(picture), cv2.COLOR_RGB2GRAY))


def spanned(values: NDArray[np.float32], span: tuple[float, float] = ROBOT_SPAN_C) -> Grey:
    """Give values (H, W) the greys that fill a span, by default those of degC of the robot's own camera."""
    low, high = span
    return _whole_grey((values - np.float32(low)) * np.float32(255.0 / (high - low)))


def _whole_grey(grey: NDArray[np.float32]) -> Grey:
    return np.asarray(np.clip(np.rint(grey), 0, 255), dtype=np.uint8)


class AutomaticGrey:
    """Brings any pictures to the contrast that the tracker is made for.

    The span of the scene fills the grey scale, unless its clutter would then be as strong as people are: the
    contrast of neighbouring places, which is higher than `CLUTTER_GREY` in a third of them. A span of noise
    alone is not stretched either. What is measured is a low pass over the pictures so far, so that the grey
    of a thing changes slowly.
    """

    def __init__(self) -> None:
        self._measured: NDArray[np.float64] | None = None

    def __call__(self, values: NDArray[np.float32]) -> Grey:
        """Turn values (H, W) of any unit into grey."""
        now = _measure(values)
        before = now if self._measured is None else self._measured
        self._measured = before + (now - before) / MEMORY_FRAMES
        low, high, clutter, noise = self._measured
        span = max(high - low, NOISE_SPAN * noise, 255.0 / CLUTTER_GREY * clutter, 1e-6)
        grey = 127.5 + (values - np.float32((low + high) / 2)) * np.float32(255.0 / span)
        return _whole_grey(grey)


def _measure(values: NDArray[np.float32]) -> NDArray[np.float64]:
    """Measure low and high, clutter and noise of a picture (H, W); a few bright pixels do not count."""
    few = values[::2, ::2]
    away = max(few.shape[0] // 40, 1)
    across, down = few[:, 2 * away :] - few[:, : -2 * away], few[2 * away :] - few[: -2 * away]
    clutter = np.percentile(np.abs(np.concatenate([across.ravel(), down.ravel()])), 70)
    low, high = np.percentile(few, [1, 99])
    return np.array([low, high, clutter, noise_of(values)], dtype=np.float64)


def grey_maker(
    radiometry: Radiometry, *, is_grey: bool, by_contrast: bool
) -> Callable[[NDArray[np.float32]], Grey]:
    """Choose how values become grey.

    Args:
        radiometry: what is known of the pixels.
        is_grey: whether the pictures have 8 bits.
        by_contrast: whether they are for a tracker to which only contrast matters: it gets 8-bit pictures as
            they are.
    """
    if by_contrast:
        return partial(spanned, span=radiometry.span_c or (0.0, 255.0)) if is_grey else local_grey
    return spanned if radiometry.is_known else AutomaticGrey()
