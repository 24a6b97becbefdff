"""Read footage of any kind as frames: thermal with optional colour, colour with depth, or panoramas."""

from collections.abc import Callable, Iterator
from typing import Any, Protocol

from peopleboy.scenarios.drawing.overlay import Picture
from peopleboy.scenarios.footage.options import (
    TrackOptions,
)
from peopleboy.scenarios.footage.panorama_views import PanoramaViews
from peopleboy.scenarios.footage.rgbd_views import RgbdViews
from peopleboy.scenarios.footage.thermal_views import ThermalViews
from peopleboy.tracker.frame import Frame


class Views(Protocol):
    """A sequence of frames.

    Attributes:
        camera: name of the camera in whose image boxes are given and drawn.
        cameras: names of all available cameras.
        expected: expected number of frames; a damaged video has fewer.
        is_exact: whether `expected` is exact.
        numbers: numbers in the images' file names, in order; None if there are none.
        rate_hz: frames per second; those of a live source are known after reading.
        stop: ends reading after the present frame; None if only the footage ends it.
    """

    camera: str
    cameras: tuple[str, ...]
    expected: int
    is_exact: bool
    numbers: range | None
    rate_hz: float
    stop: Callable[[], None] | None

    @property
    def notes(self) -> list[str]:
        """Notes on the interpretation of the inputs; complete after reading."""
        ...

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames one by one.

        Raises:
            BadInput: an image is unusable.
        """
        ...

    def picture(self, frame: Frame) -> Picture:
        """Return a frame as a picture for display, (H, W, 3) RGB."""
        ...

    def about(self) -> dict[str, Any]:
        """Describe the images, for run.json."""
        ...


def open_views(options: TrackOptions) -> Views:
    """Open thermal footage, colour with depth, or panoramas.

    Raises:
        BadInput: the footage cannot be read, or an option is for another kind.
    """
    if options.panorama is not None:
        return PanoramaViews(options, options.panorama)
    return ThermalViews(options) if options.rgbd is None else RgbdViews(options, options.rgbd)
