"""Draw images of one person and the single filter of the thesis on people tracking: figures 4.1 to 4.10."""

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from peopleboy.random_streams import stream
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.studies.reproductions.canvas import ORANGE, canvas, show_image
from peopleboy.studies.reproductions.experiments.playback import play
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.reproductions.contour.explanation import Ellipse
from peopleboy.tracker.reproductions.contour.measurement.section_evidence import outline
from peopleboy.tracker.reproductions.contour.particles import X, Y
from peopleboy.tracker.reproductions.contour.single_filter import SingleFilter
from peopleboy.tracker.reproductions.contour.variants import THESIS_SINGLE

WARM_SCENE: Final = "empty_room"
SEVERAL: Final = (("single_stationary", 6.0), ("crossing_2", 3.0), ("crossing_3", 4.0), ("crossing_4", 5.0))
VIEWS: Final = (
    ("fast_turn", 5.0),
    ("single_stationary", 8.0),
    ("single_stationary", 14.0),
    ("single_stationary", 20.0),
)
FAILURES: Final = (("sitting", 12.0), ("sitting", 16.0), ("fast_turn", 8.0), ("fast_turn", 12.0))
"""Scenarios, and the times [s] of the drawn images."""
_WARM_S: Final = (0.0, 6.0, 8.5, 11.0)
_SEED: Final = 0
_WIDE: Final = 2
_HIGH_IN: Final = 6.0
_GREY: Final = {"cmap": "gray", "vmin": 0, "vmax": 255}


class FilteredImage(NamedTuple):
    """A thermal image with the single filter's samples.

    Attributes:
        time_s: time of the image.
        grey: (H, W) image.
        middles: (N, 2) [px] of the samples' body ellipses.
        contour: of the person; None if none is detected.
    """

    time_s: float
    grey: NDArray[np.uint8]
    middles: NDArray[np.float32]
    contour: Ellipse | None


def filtered_images(scenario: str, last_s: float) -> Iterator[FilteredImage]:
    """Play a scenario up to a time, with the literal tracker of one person."""
    tracker = SingleFilter(THESIS_SINGLE, stream(_SEED, "reproduce.single_person"))
    for moment in play(load_scenario(scenario), _SEED, THERMAL, images=(THERMAL,)):
        tracker.update(moment.frame)
        found = tracker.explanation
        (samples,) = found.particles.values()
        contour = next(iter(found.ellipses.values()), None)
        time_s = moment.frame.time_s
        yield FilteredImage(time_s, moment.frame.grey(THERMAL).copy(), samples.state[:, (X, Y)], contour)
        if time_s >= last_s - 1e-6:
            return


def draw_warm_things() -> Figure:
    """Draw warm objects without people: figure 4.1."""
    page = canvas(_HIGH_IN)
    moments = play(load_scenario(WARM_SCENE), _SEED, THERMAL, images=(THERMAL,))
    for time_s, axes in zip(_WARM_S, page.subplots(2, _WIDE).flat, strict=True):
        moment = next(one for one in moments if one.frame.time_s >= time_s - 1e-6)
        show_image(axes, moment.frame.grey(THERMAL), f"{WARM_SCENE}, {time_s:g} s", **_GREY)
    return page


def draw_several_people() -> Figure:
    """Draw the samples of the single filter with one person and with several: figure 4.5."""
    return _draw(SEVERAL)


def draw_views() -> Figure:
    """Draw the contour of a person seen from the side, the front and the back: figure 4.7."""
    return _draw(VIEWS)


def draw_failures() -> Figure:
    """Draw the contour where the model fails: figure 4.10."""
    return _draw(FAILURES)


def _draw(images: Sequence[tuple[str, float]]) -> Figure:
    page = canvas(_HIGH_IN)
    for (scenario, time_s), axes in zip(images, page.subplots(2, _WIDE).flat, strict=True):
        *_, last = filtered_images(scenario, time_s)
        _draw_filtered(axes, scenario, last)
    return page


def _draw_filtered(axes: Axes, scenario: str, image: FilteredImage) -> None:
    found = "not detected" if image.contour is None else "detected"
    show_image(axes, image.grey, f"{scenario}, {image.time_s:.1f} s: {found}", **_GREY)
    axes.plot(*image.middles.T, ".", color=ORANGE, markersize=1.0, alpha=0.5)
    if image.contour is not None:
        for line in outline(image.contour):
            axes.plot(*line.T, color="#00b3ff", linewidth=1.2)
    axes.set(xlim=(-0.5, image.grey.shape[1] - 0.5), ylim=(image.grey.shape[0] - 0.5, -0.5))
