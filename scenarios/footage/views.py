"""Footage of any kind as a tracker sees it, and as people are shown it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol

from peopleboy.scenarios.drawing.overlay import Picture
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.rgbd_views import RgbdViews
from peopleboy.scenarios.footage.thermal_views import ThermalViews
from peopleboy.tracker.frame import Frame


class Views(Protocol):
    """A row of frames.

    Attributes:
        camera: name of that in whose image people are boxed and drawn.
        cameras: names of all that a tracker may want.
        expected: how many frames there should be; a damaged video has fewer.
        is_exact: whether there are exactly as many.
        numbers: those in the pictures' names, in a row; None if they tell none.
        rate_hz: frames a second.
    """

    camera: str
    cameras: tuple[str, ...]
    expected: int
    is_exact: bool
    numbers: range | None
    rate_hz: float

    @property
    def notes(self) -> list[str]:
        """What was taken as something else than it is, to be told once; complete after reading."""
        ...

    def __iter__(self) -> Iterator[Frame]:
        """Read them one by one.

        Raises:
            BadInput: a picture that cannot be used.
        """
        ...

    def picture(self, frame: Frame) -> Picture:
        """Show one of them to people, (H, W, 3) RGB."""
        ...

    def about(self) -> dict[str, Any]:
        """Say what the pictures are, for run.json."""
        ...


def open_views(options: TrackOptions) -> Views:
    """Open thermal footage, or colour with depth.

    Raises:
        BadInput: it cannot be read, or an option is of the other kind.
    """
    return ThermalViews(options) if options.rgbd is None else RgbdViews(options, options.rgbd)
