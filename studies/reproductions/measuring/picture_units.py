"""Units of work that draw pictures of films."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from matplotlib.figure import Figure

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.pictures.canvas import png_address
from peopleboy.studies.reproductions.pictures.panoramic_figures import (
    draw_features,
    draw_fields_of_view,
    draw_set_up,
    draw_webcam_images,
)
from peopleboy.studies.reproductions.pictures.situation_figures import (
    draw_examples,
    draw_excitation,
    draw_focus_paths,
    draw_part_scores,
)
from peopleboy.studies.reproductions.pictures.tracking_figures import (
    draw_cues,
    draw_errors,
    draw_example,
    draw_fitness,
    draw_interaction,
    draw_time_ranges,
)

DRAWN: Mapping[str, Callable[[], Figure]] = {
    "figure-3.4": draw_errors,
    "figure-3.5": draw_example,
    "figure-4.4": draw_fitness,
    "figure-5.3": draw_interaction,
    "figure-7.2": draw_cues,
    "paper-figure-4": draw_time_ranges,
    "panoramic-figure-1": draw_set_up,
    "panoramic-figure-2": draw_webcam_images,
    "panoramic-figure-3": draw_fields_of_view,
    "panoramic-figure-4": draw_features,
    "situation-figure-5.6": draw_excitation,
    "situation-figure-5.7": draw_part_scores,
    "situation-figure-5.8": draw_focus_paths,
    "situation-figure-5.9": draw_examples,
}
"""The figures that need recordings of their own, by id of the experiment."""


@dataclass(frozen=True, slots=True)
class PictureUnit:
    """A picture, as the address of a page's image.

    Attributes:
        name: id of the experiment.
    """

    name: str
    is_timing: bool = False

    @property
    def key(self) -> str:
        """Which one."""
        return f"picture {self.name}"

    def run(self) -> Result:
        """Play what it needs, and draw it."""
        return {"picture": png_address(DRAWN[self.name]())}
