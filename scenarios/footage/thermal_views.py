"""Thermal footage as a tracker sees it, with colour if there is any."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import Picture, show_thermal
from peopleboy.scenarios.footage.checks import check_first, colour_picture
from peopleboy.scenarios.footage.options import DEFAULT_RATE_HZ, TrackOptions
from peopleboy.tracker.footage.grey import check_plausible, grey_maker
from peopleboy.tracker.footage.pictures import open_footage
from peopleboy.tracker.footage.sequence_info import find_info, rate_in
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.trackers import BY_CONTRAST

COLOUR_TRACKER: Final = "colour"
"""It differs from `thermal` by what colours add alone."""


class ThermalViews:
    """Thermal pictures of a folder or a video.

    Raises:
        BadInput: they cannot be read, or the tracker needs colour and there is none.
    """

    camera = THERMAL
    cameras: tuple[str, ...] = (THERMAL, COLOUR)

    def __init__(self, options: TrackOptions) -> None:
        if options.tracker == COLOUR_TRACKER and options.colour is None:
            raise BadInput("--tracker colour: needs --colour FOLDER; without it, give --tracker thermal")
        self._options = options
        self._footage = open_footage(options.footage)
        self._colour = None if options.colour is None else open_footage(options.colour)
        self.expected, self.is_exact = self._footage.expected, self._footage.is_exact
        self.numbers = self._footage.numbers
        self.rate_hz = options.rate_hz or self._footage.rate_hz or self._told_rate() or DEFAULT_RATE_HZ

    def _told_rate(self) -> float | None:
        """Read the rate from what lies beside the pictures."""
        path = find_info(self._options.footage)
        rate = None if path is None else rate_in(path)
        if rate is not None:
            self._footage.notes.append(
                f"{path}: {rate:g} pictures a second are taken from there; --rate-hz goes first"
            )
        return rate

    @property
    def notes(self) -> list[str]:
        """What was taken as something else than it is."""
        return [*self._footage.notes, *([] if self._colour is None else self._colour.notes)]

    def __iter__(self) -> Iterator[Frame]:
        """Read thermal pictures, and colour ones along with them.

        Raises:
            BadInput: a picture that cannot be used, or a colour picture too few or too many.
        """
        options, radiometry, notes = self._options, self._options.radiometry, self._footage.notes
        to_grey = None
        for number, (thermal, picture) in enumerate(self._pictures()):
            if number == 0:
                check_first(thermal, options)
                self._note_counts(thermal)
            values = radiometry.values(thermal, notes)
            if number == 0:
                check_plausible(radiometry, values)
            if to_grey is None:
                to_grey = grey_maker(
                    radiometry,
                    is_grey=thermal.dtype == np.uint8,
                    by_contrast=options.tracker in BY_CONTRAST,
                )
            images: dict[str, NDArray[np.uint8]] = {THERMAL: to_grey(values)}
            if picture is not None:
                images[COLOUR] = colour_picture(picture, "--colour")
            yield Frame(images=images, time_s=number / self.rate_hz)

    def _pictures(self) -> Iterator[tuple[NDArray[Any], NDArray[Any] | None]]:
        here, there = self._options.footage, self._options.colour
        colours = () if self._colour is None else self._colour
        for number, (thermal, picture) in enumerate(zip_longest(self._footage, colours)):
            if thermal is None or (self._colour is not None and picture is None):
                shorter, longer = (here, there) if thermal is None else (there, here)
                raise BadInput(
                    f"{shorter}: ends after {number} pictures, before {longer}; both must be as long"
                )
            yield thermal, picture

    def _note_counts(self, thermal: NDArray[Any]) -> None:
        if thermal.dtype != np.uint8 and not self._options.radiometry.is_known:
            self._footage.notes.append(
                f"{thermal.dtype} pictures without --scale: degC are unknown, "
                "grey follows the scene's contrast"
            )

    def picture(self, frame: Frame) -> Picture:
        """Show the grey of a frame."""
        return show_thermal(frame.grey(THERMAL))

    def about(self) -> dict[str, Any]:
        """Say what is known of the pixels."""
        colour, radiometry = self._options.colour, self._options.radiometry
        return {
            "colour": None if colour is None else colour.name,
            "temperature_range_c": radiometry.span_c,
            "scale": radiometry.scale,
        }
