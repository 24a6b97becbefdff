"""How the panoramic camera sits on the robot: figure 1 of the 2003 paper, as a drawing to scale."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.cameras.camera_config import PanoramaConfig
from peopleboy.sim.config import WorldConfig
from peopleboy.sim.geometry.mirror import Mirror
from peopleboy.sim.world import World
from peopleboy.studies.reproductions.pictures.png import canvas, label

SCENE: Final = "room_long"
_AT_S: Final = 8.0
_FARTHEST_M: Final = 6.0
_RAY, _BODY, _MIRROR = "#d95f02", "#9aa3ad", "#1f78b4"


def draw_set_up() -> Figure:
    """Draw lens, mirror and lines of sight from the side, and the round image that the lens sees."""
    page = canvas(2.5)
    side, close, raw = page.subplots(1, 3, gridspec_kw={"width_ratios": (1.6, 0.8, 1)})
    mirror = PanoramaConfig().camera.mirror
    _draw_side(side, mirror)
    _draw_mirror(close, mirror)
    raw.imshow(_round_image())
    raw.set_axis_off()
    label(raw, "what the lens sees")
    return page


def _draw_side(axes: Axes, mirror: Mirror) -> None:
    """Draw the robot, a person, and the steepest and the flattest line of sight."""
    axes.add_patch(Rectangle((-0.2, 0.0), 0.4, 1.2, color=_BODY))
    axes.add_patch(Rectangle((-0.03, 1.2), 0.06, mirror.apex_m - 1.2, color=_BODY))
    steep, flat = mirror.axis_rad, mirror.axis_rad - mirror.lens_half_angle_rad
    for angle in (steep, flat):
        reach = min(mirror.ring_height_m / math.tan(angle), _FARTHEST_M)
        axes.plot(
            [0.0, reach], [mirror.ring_height_m, mirror.ring_height_m - reach * math.tan(angle)], color=_RAY
        )
    axes.add_patch(Rectangle((3.0 - 0.18, 0.0), 0.36, 1.5, color="#cfd8c8"))
    axes.add_patch(Rectangle((3.0 - 0.1, 1.52), 0.2, 0.23, color="#cfd8c8"))
    axes.axhline(0.0, color="black", linewidth=0.8)
    axes.set_xlim(-0.5, _FARTHEST_M)
    axes.set_ylim(-0.1, 2.0)
    axes.set_aspect("equal")
    words = f"{math.degrees(flat):.0f} to {math.degrees(steep):.0f} deg below the horizon"
    label(axes, f"{words}, from {mirror.ring_height_m:.2f} m", "m", "m")


def _draw_mirror(axes: Axes, mirror: Mirror) -> None:
    """Draw the cone over the lens, and how it turns the lens's rays outwards."""
    radius = 0.09
    top = mirror.apex_m + radius / math.tan(mirror.half_apex_rad)
    axes.add_patch(Polygon([(0.0, mirror.apex_m), (radius, top), (-radius, top)], color=_MIRROR, alpha=0.6))
    lens = mirror.apex_m - mirror.lens_m
    axes.plot(0.0, lens, "ko", markersize=5)
    for angle in np.linspace(0.12, 0.98, 4) * mirror.lens_half_angle_rad:
        x, y = _met(mirror, float(angle))
        down = mirror.axis_rad - angle
        axes.plot(
            [0.0, x, x + 0.1 * math.cos(down)], [lens, y, y - 0.1 * math.sin(down)], color=_RAY, linewidth=1.0
        )
    axes.set_xlim(-0.1, 0.16)
    axes.set_aspect("equal")
    label(axes, "cone and lens", "m", "")


def _met(mirror: Mirror, angle: float) -> tuple[float, float]:
    """Tell where the ray that leaves the lens at an angle [rad] off its axis meets the mirror: x, y [m]."""
    # x = (y - lens) tan(angle) and x = (y - apex) tan(half apex)
    spread, side = math.tan(angle), math.tan(mirror.half_apex_rad)
    y = (mirror.apex_m * side - (mirror.apex_m - mirror.lens_m) * spread) / (side - spread)
    return (y - mirror.apex_m) * side, y


def _round_image() -> NDArray[np.uint8]:
    config = load_scenario(SCENE).world(0)
    with World(_with_round_image(config)) as world:
        for _ in range(round(_AT_S * config.control_hz)):
            world.step(0.0, 0.0)
        return np.asarray(world.observe().images["panorama_raw"], np.uint8)


def _with_round_image(config: WorldConfig) -> WorldConfig:
    cameras = {**config.robot.cameras, "panorama": PanoramaConfig(raw=True)}
    return replace(config, robot=replace(config.robot, cameras=cameras))
