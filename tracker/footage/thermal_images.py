"""Conversion of the images of one thermal camera to frames of a tracker."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.tracker.footage.false_colours import FalseColours
from peopleboy.tracker.footage.grey import (
    LEAST_SIDE_PX,
    Radiometry,
    are_bytes_swapped,
    check_plausible,
    fill_outside,
    grey_maker,
)
from peopleboy.tracker.footage.lens import Lens
from peopleboy.tracker.footage.read_picture import read_picture, size_of
from peopleboy.tracker.footage.read_tiff import Raw
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame

_DEPTHS: Final = ("uint8", "uint16", "float32")


class ThermalImages:
    """Converts raw images to frames, one after the other.

    Args:
        radiometry: known properties of the pixels.
        by_contrast: whether the tracker uses contrast only; see `grey_maker`.
        where: name of the images in messages.
        mask: (H, W) where people are searched for; None for everywhere.
        lens: distortion that is corrected; None for none.
        calibrate: returns the calibration for a width and height [px]; None if it is unknown.

    Attributes:
        notes: notes on the interpretation of the images.
    """

    def __init__(
        self,
        radiometry: Radiometry | None = None,
        *,
        by_contrast: bool = True,
        where: str = "image",
        mask: NDArray[np.bool_] | None = None,
        lens: Lens | None = None,
        calibrate: Callable[[int, int], Calibration] | None = None,
    ) -> None:
        self._radiometry = Radiometry() if radiometry is None else radiometry
        self._mask, self._lens, self._calibrate = mask, lens, calibrate
        self._calibrations: dict[str, Calibration] = {}
        self._by_contrast = by_contrast
        self._where = where
        self._first: Raw | None = None
        self._time_s = -np.inf
        self._colours = FalseColours()
        self.notes: list[str] = []

    def frame(self, image: NDArray[Any], time_s: float, colour: NDArray[np.uint8] | None = None) -> Frame:
        """Return the frame of the next image.

        Args:
            image: (H, W) uint8, uint16 or float32, or (H, W, 3) uint8 RGB; as large as the first.
            time_s: when it was taken [s]; later than the one before.
            colour: (H', W', 3) uint8 RGB image of the same view; None for none.

        Raises:
            BadInput: the image is of another kind or size, is not later, or holds implausible temperatures.
        """
        is_first = self._first is None
        self._check(image, time_s)
        values = self._radiometry.values(self._colours.grey(image, self.notes))
        if self._mask is not None:
            values = fill_outside(values, self._mask)
        if self._lens is not None:
            values = self._lens.undistort(values)
        if is_first:
            if self._calibrate is not None:
                self._calibrations = {THERMAL: self._calibrate(image.shape[1], image.shape[0])}
            self._note_counts(image)
            check_plausible(self._radiometry, values)
            self._to_grey = grey_maker(
                self._radiometry, is_grey=image.dtype == np.uint8, by_contrast=self._by_contrast
            )
        images: dict[str, NDArray[np.uint8]] = {THERMAL: self._to_grey(values)}
        if colour is not None:
            images[COLOUR] = colour
        return Frame(images=images, time_s=time_s, calibrations=self._calibrations)

    def _check(self, image: NDArray[Any], time_s: float) -> None:
        check_image(image, self._where)
        first = image if self._first is None else self._first
        if image.shape[:2] != first.shape[:2]:
            raise BadInput(
                f"{self._where}: must have the size of the first, {size_of(first)}, got {size_of(image)}; "
                "a new size needs a new tracker"
            )
        if image.dtype != first.dtype:
            raise BadInput(f"{self._where}: must be {first.dtype} as the first, got {image.dtype}")
        if self._mask is not None and self._mask.shape != image.shape[:2]:
            raise BadInput(
                f"--mask: must have the size of the images, {size_of(image)}, got {size_of(self._mask)}"
            )
        if not time_s > self._time_s:
            raise BadInput(f"time_s must be later than that of the last image, {self._time_s}, got {time_s}")
        self._first, self._time_s = first, time_s

    def _note_counts(self, image: NDArray[Any]) -> None:
        if are_bytes_swapped(image):
            self.notes.append(
                "the two bytes of each 16-bit count seem to be exchanged, as in PNG files of some cameras; "
                "exchange them before, for example by numpy.ndarray.byteswap"
            )
        if image.dtype != np.uint8 and not self._radiometry.is_known:
            self.notes.append(
                f"{image.dtype} images without --scale: temperatures are unknown, "
                "grey levels are stretched to the contrast of the scene"
            )


def read_mask(path: Path) -> NDArray[np.bool_]:
    """Read a mask (H, W) from a picture: people are searched for where it is not black.

    Raises:
        BadInput: it cannot be read, or is all black.
    """
    picture = read_picture(path, [])
    mask = picture.any(axis=2) if picture.ndim == 3 else picture > 0
    if not mask.any():
        raise BadInput(f"{path}: is all black; people are searched for where a mask is not black")
    return np.asarray(mask)


def check_image(image: object, where: str) -> None:
    """Refuse an image that no tracker can use.

    Raises:
        BadInput: it is of another kind than `Raw`, or too small; `where` names it in the message.
    """
    rule = f"{where}: must be (H, W) {', '.join(_DEPTHS)}, or (H, W, 3) uint8"
    if not isinstance(image, np.ndarray):
        raise BadInput(f"{rule}, got {type(image).__name__}")
    is_grey = image.ndim == 2 and image.dtype.name in _DEPTHS
    is_colour = image.ndim == 3 and image.shape[2] == 3 and image.dtype == np.uint8
    if not is_grey and not is_colour:
        raise BadInput(f"{rule}, got {image.shape} {image.dtype}")
    if min(image.shape[:2]) < LEAST_SIDE_PX:
        least = f"{LEAST_SIDE_PX}x{LEAST_SIDE_PX}"
        raise BadInput(f"{where}: must be at least {least}, got {size_of(image)}")
