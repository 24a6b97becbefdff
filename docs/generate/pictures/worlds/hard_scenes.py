"""Picture of the library's scenes with realistic difficulties for a thermal camera."""

from __future__ import annotations

from typing import Final

import cv2
from matplotlib.figure import Figure

from docs.generate.pictures.moments import world_at
from docs.generate.pictures.paper import panels, show

SCENES: Final = {
    "warm_office": 5.0,
    "kitchen_morning": 5.0,
    "glass_corridor": 6.0,
    "street_evening": 6.0,
    "sunny_hall": 5.0,
    "garage": 5.0,
    "workshop": 6.0,
    "crowded_foyer": 6.0,
}
_GREYS: Final = 14  # quantisation step, for small files


def hard_scenes() -> Figure:
    """Draw one image of each scene, as captured by the robot."""
    figure, axes = panels(tuple(SCENES), 5.0, columns=4)
    for panel, (scene, time_s) in zip(axes, SCENES.items(), strict=True):
        with world_at(scenario=scene, seed=0, time_s=time_s) as world:
            grey = world.observe().images["thermal"]
        smooth = cv2.GaussianBlur(grey, (0, 0), 0.5)  # noise makes up most of the file size
        show(panel, smooth // _GREYS * _GREYS)
    return figure
