"""The figures that need films of their own; drawing them needs PyBullet."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from matplotlib.figure import Figure

from peopleboy.studies.reproductions.pictures.attention_maps import (
    draw_examples,
    draw_excitation,
    draw_parts,
    draw_paths,
)
from peopleboy.studies.reproductions.pictures.frame_example import draw_example
from peopleboy.studies.reproductions.pictures.interaction import draw_interaction
from peopleboy.studies.reproductions.pictures.set_up import draw_set_up
from peopleboy.studies.reproductions.pictures.silhouette import draw_features
from peopleboy.studies.reproductions.pictures.thermal_contours import draw_cues, draw_fitness
from peopleboy.studies.reproductions.pictures.time_ranges import draw_time_ranges
from peopleboy.studies.reproductions.pictures.typical_errors import draw_errors
from peopleboy.studies.reproductions.pictures.webcam_views import (
    draw_fields_of_view,
    draw_webcam_images,
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
    "situation-figure-5.7": draw_parts,
    "situation-figure-5.8": draw_paths,
    "situation-figure-5.9": draw_examples,
}
"""By id of the experiment."""
