"""Read thermal footage, with colour if there is any, as frames."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from itertools import chain, islice, zip_longest
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import Picture, show_thermal
from peopleboy.scenarios.footage.detect_polarity import LOOK_AHEAD, detect_polarity
from peopleboy.scenarios.footage.frame_times import given_times, rate_of, time_of
from peopleboy.scenarios.footage.options import (
    DEFAULT_RATE_HZ,
    FootageCamera,
    TrackOptions,
    check_start,
    colour_picture,
)
from peopleboy.tracker.footage.depth_pictures import pair_up
from peopleboy.tracker.footage.false_colours import FalseColours
from peopleboy.tracker.footage.grey import Polarity, Radiometry
from peopleboy.tracker.footage.image_sequences import Footage, PictureFolder, open_footage
from peopleboy.tracker.footage.lens import Lens, read_lens
from peopleboy.tracker.footage.live_footage import LiveFootage, LiveSource
from peopleboy.tracker.footage.picture_names import offsets_of
from peopleboy.tracker.footage.sequence_info import find_info, rate_in
from peopleboy.tracker.footage.thermal_images import ThermalImages, read_mask
from peopleboy.tracker.footage.time_stamps import time_stamps
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.trackers import uses_contrast

COLOUR_TRACKER: Final = "colour"
"""Tracker that differs from `thermal` only in its use of colour."""


class ThermalViews:
    """Thermal images of a folder, a video or a live source.

    Raises:
        BadInput: the images cannot be read, or the tracker needs colour and there is none.
    """

    camera = THERMAL
    cameras: tuple[str, ...] = (THERMAL, COLOUR)

    def __init__(self, options: TrackOptions) -> None:
        if options.tracker == COLOUR_TRACKER and options.colour is None:
            raise BadInput("--tracker colour: needs --colour FOLDER; add it, or give --tracker thermal")
        if options.odometry is not None:
            raise BadInput("--odometry: needs --depth or --panorama; add one of them, or leave it out")
        self._options = options
        self._images: ThermalImages | None = None
        self._mask = None if options.mask is None else read_mask(options.mask)
        self._lens = None if options.calibration is None else read_lens(options.calibration)
        self._mount = _mount_of(options, self._lens)
        self._footage: Footage
        self.stop: Callable[[], None] | None = None
        if isinstance(options.footage, LiveSource):
            self._footage = live = LiveFootage(options.footage, options.rate_hz)
            self.stop = live.stop
        else:
            self._footage = open_footage(options.footage)
        self._colour = None if options.colour is None else open_footage(options.colour)
        self._pair_up()
        names = [path.name for path in paths] if (paths := _paths_of(self._footage)) else None
        self._times_s = given_times(options, names or _numbers(self._footage.expected))
        self._offsets = offsets_of(paths)
        if time_stamps(paths) is not None and self._times_s is None:
            use = "used" if options.rate_hz is None else "not used, as --rate-hz says otherwise"
            self._footage.notes.append(f"names of images contain their times, which are {use}")
        self.expected, self.is_exact = self._footage.expected, self._footage.is_exact
        self.numbers = self._footage.numbers
        self.rate_hz = (
            options.rate_hz
            or rate_of(self._times_s)
            or self._footage.rate_hz
            or self._given_rate()
            or DEFAULT_RATE_HZ
        )

    def _pair_up(self) -> None:
        """Leave out the images of two folders that have no counterpart."""
        if not isinstance(self._footage, PictureFolder) or not isinstance(self._colour, PictureFolder):
            return
        pairs = pair_up(self._footage.paths, self._colour.paths, "colour")
        self._footage.take(pairs.colour)
        self._colour.paths = list(pairs.depth)
        if pairs.note:
            self._footage.notes.append(pairs.note)

    def _time_s(self, number: int) -> float:
        """Return the time of an image, from 0: that of its time stamp, or an even one, with gaps."""
        is_own = self._options.rate_hz is None or isinstance(self._footage, LiveFootage)
        own = self._footage.times_s if is_own else None
        return time_of(self._options, self._times_s or own, self._offsets, number, self.rate_hz)

    def _given_rate(self) -> float | None:
        """Read the frame rate from a file beside the images."""
        footage = self._options.path
        path = None if footage is None else find_info(footage)
        rate = None if path is None else rate_in(path)
        if rate is not None:
            self._footage.notes.append(
                f"{path}: gives the frame rate, {rate:g} Hz; use --rate-hz to override it"
            )
        return rate

    @property
    def notes(self) -> list[str]:
        """Notes on the interpretation of the inputs."""
        colour = [] if self._colour is None else self._colour.notes
        images = [] if self._images is None else self._images.notes
        if self._mount is not None:
            images = [*images, *self._mount.notes]
        return [*self._footage.notes, *images, *colour]

    def __iter__(self) -> Iterator[Frame]:
        """Yield frames with thermal images, and with colour images if there are any.

        Raises:
            BadInput: an image is unusable, or the numbers of thermal and colour images differ.
        """
        pictures = self._pictures()
        first = list(islice(pictures, self._look_ahead))
        self._images = ThermalImages(
            self._radiometry([thermal for thermal, _ in first]),
            by_contrast=uses_contrast(self._options.tracker),
            where=str(self._options.footage),
            mask=self._mask,
            lens=self._lens,
            calibrate=None if self._mount is None else self._mount.calibration,
        )
        for number, (thermal, picture) in enumerate(chain(first, pictures)):
            if number == 0:
                check_start(thermal, self._options)
            colour = None if picture is None else colour_picture(picture, "--colour")
            yield self._images.frame(thermal, self._time_s(number), colour)
        if isinstance(self._footage, LiveFootage):
            self.rate_hz = rate_of(self._footage.times_s) or self.rate_hz

    @property
    def _look_ahead(self) -> int:
        """Number of images that are needed to begin."""
        radiometry = self._options.radiometry
        is_asked = radiometry.polarity is None and not radiometry.is_known and self.stop is None
        return LOOK_AHEAD if is_asked else 0

    def _radiometry(self, first: Sequence[NDArray[Any]]) -> Radiometry:
        """Return the meaning of the pixels, with the polarity of 8-bit images if it was detected."""
        radiometry = self._options.radiometry
        if not first or first[0].dtype != np.uint8:
            return radiometry
        colours = FalseColours()
        if detect_polarity([colours.grey(image, []) for image in first]) is not Polarity.BLACK_HOT:
            return radiometry
        self._footage.notes.append(
            "people are darker than what is around them, so dark pixels are taken as warm; if people are "
            "colder than it, give --polarity white-hot"
        )
        return replace(radiometry, polarity=Polarity.BLACK_HOT)

    def _pictures(self) -> Iterator[tuple[NDArray[Any], NDArray[Any] | None]]:
        here, there = self._options.footage, self._options.colour
        colours = () if self._colour is None else self._colour
        for number, (thermal, picture) in enumerate(zip_longest(self._footage, colours)):
            if thermal is None or (self._colour is not None and picture is None):
                shorter, longer = (here, there) if thermal is None else (there, here)
                raise BadInput(
                    f"{shorter}: ends after {number} images, before {longer}; both need the same number"
                )
            yield thermal, picture

    def picture(self, frame: Frame) -> Picture:
        """Return the grey image of a frame."""
        return show_thermal(frame.grey(THERMAL))

    def about(self) -> dict[str, Any]:
        """Describe the meaning of the pixel values."""
        colour, radiometry = self._options.colour, self._options.radiometry
        mount, given = self._mount, (self._options.calibration, self._options.mask)
        calibration, mask = (None if path is None else path.name for path in given)
        return {
            "colour": None if colour is None else colour.name,
            "temperature_range_c": radiometry.span_c,
            "scale": radiometry.scale,
            "camera": None if mount is None else asdict(mount),
            "calibration": calibration,
            "mask": mask,
        }


def _paths_of(footage: Footage) -> list[Path]:
    return footage.paths if isinstance(footage, PictureFolder) else []


def _numbers(count: int) -> list[str]:
    return [str(number) for number in range(1, count + 1)]


def _mount_of(options: TrackOptions, lens: Lens | None) -> FootageCamera | None:
    """Return pose and field of view of the thermal camera, which a calibration file can complete."""
    mount = options.mount
    if mount is None:
        return None
    mount = replace(mount, pitch_deg=mount.pitch_deg or 0.0)
    is_known = mount.focal_px is not None or mount.vertical_fov_deg is not None
    if lens is not None and is_known:
        raise BadInput("--calibration has the focal length; leave --focal-px and --vertical-fov-deg out")
    if lens is not None:
        return replace(mount, focal_px=lens.focal_px)
    if not is_known:
        raise BadInput(
            "positions on the floor need --vertical-fov-deg, --focal-px or --calibration beside "
            "--camera-height-m; add one of them"
        )
    return mount
