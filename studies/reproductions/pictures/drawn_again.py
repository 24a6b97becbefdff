"""The figures that need films of their own; drawing them needs PyBullet."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from matplotlib.figure import Figure

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
"""By id of the experiment."""
