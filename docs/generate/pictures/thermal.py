"""Pictures of thermal imaging: from temperatures to greys, and effects of the electronics."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, get_args

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from docs.generate.pictures.moments import world_at
from docs.generate.pictures.paper import panels, plot, show
from peopleboy.random_streams import stream
from peopleboy.sim.cameras.camera_config import ColourConfig, ThermalConfig
from peopleboy.sim.cameras.imaging.electronics import Gain, compress, encode_8bit, sharpen, show_scene
from peopleboy.sim.cameras.imaging.noise import Drift
from peopleboy.sim.cameras.thermal import band_radiance, detect, make_detector, surface_image
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.people.body.anthropometry import Sex
from peopleboy.sim.people.body.clothes import BOTTOMS, SKIN_C, TOPS, Clothes
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.places.furniture.thing_config import KINDS
from peopleboy.sim.places.make_place import build_place
from peopleboy.sim.places.place_config import straight_corridor
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.shapes.materials import Detail
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig

SCALE = {"cmap": "inferno", "vmin": 18.0, "vmax": 38.0}
ROOM_C = 21.0
CLOTH, SKIN, PAINT = 0.95, 0.98, 0.93
_THREE: tuple[tuple[str, tuple[float, float], Sex, float, Clothes], ...] = (
    (
        "ada",
        (5.7, 0.85),
        "female",
        1.68,
        Clothes(top="jacket", bottom="jeans", hair="long"),
    ),
    ("ben", (5.9, -0.02), "male", 1.80, Clothes(top="shirt", bottom="trousers", bottom_colour="khaki")),
    ("cleo", (5.6, -0.85), "female", 1.64, Clothes(top="t_shirt", top_colour="grey", bottom="jeans")),
)

_USUAL = ThermalConfig(netd_k=0.03, fixed_pattern_k=0.02)  # noise makes up most of the file size
_PLATEAU = replace(_USUAL, gain="plateau")
_DRIFT_S = 60.0
_STEP = 8  # [grey] quantisation, for small files

Grey = NDArray[np.uint8]


def steps() -> Figure:
    """Draw the steps of image formation: surface temperature, radiance through the optics, noise, grey."""
    titles = ("surface temperature", "emissivity and optics", "detector noise", "8 bit")
    figure, axes = panels(titles, 2.35)
    with world_at("crossing_4", 0, 4.0) as world:
        # The surfaces only: every part as a black body, with a perfect lens.
        config = world.config.robot.cameras["thermal"]
        assert isinstance(config, ThermalConfig)
        seen = replace(world._camera_view(config), turn_rad_s=0.0)
        black = seen.materials._replace(thermal=seen.materials.thermal.copy())
        black.thermal[:, 1] = 1.0
        surface = surface_image(replace(seen, materials=black), replace(config, blur_px=0.0))
        apparent = surface_image(seen, config)
    rng = np.random.default_rng(0)
    noisy = detect(apparent, make_detector(config, rng), config, rng)
    for panel, image in zip(axes, (surface, apparent, noisy), strict=False):
        shown = show(panel, image, **SCALE)
    show(axes[3], encode_8bit(noisy))
    figure.colorbar(shown, ax=axes[:3], label="°C", shrink=0.8, extend="both", pad=0.01)
    return figure


def bars() -> Figure:
    """Draw everyday surfaces: temperature, apparent temperature, grey."""
    surfaces = _surfaces()
    names = list(surfaces)
    true = np.array([temperature for temperature, _ in surfaces.values()])
    seen = apparent_c(true, np.array([emissivity for _, emissivity in surfaces.values()]))
    grey = encode_8bit(seen.astype(np.float32))
    figure, axes = plot(5.2)
    rows = np.arange(len(names))[::-1]
    shades = [str(value / 255.0) for value in grey]
    axes.barh(rows, np.minimum(seen, 40.0) - 14.0, left=14.0, color=shades, edgecolor="0.4", height=0.75)
    axes.plot(np.minimum(true, 40.3), rows, "o", color="#d55e00", markersize=5, label="surface temperature")
    for row, value, c in zip(rows, grey, seen, strict=True):
        axes.text(40.8, row, f"grey {value}" + (f" ({c:.0f} °C)" if c > 40 else ""), va="center", fontsize=9)
    axes.axvspan(24.0, 36.0, color="#0072b2", alpha=0.12, zorder=0, label="8-bit span: 24 to 36 °C")
    axes.set(yticks=rows, yticklabels=names, xlim=(14.0, 45.0), xlabel="apparent temperature [°C]")
    axes.legend(loc="lower center", bbox_to_anchor=(0.45, 1.0), ncol=2, frameon=False, fontsize=9)
    return figure


def mirror() -> Figure:
    """Draw the apparent temperature over emissivity and temperature of the surroundings."""
    figure, axes = plot(3.4)
    true = np.linspace(10.0, 60.0, 101)
    for emissivity, colour in ((1.0, "0.2"), (CLOTH, "#009e73"), (0.6, "#0072b2"), (0.2, "#d55e00")):
        seen = apparent_c(true, np.full_like(true, emissivity))
        axes.plot(true, seen, color=colour, label=f"emissivity {emissivity:g}")
    axes.axhspan(24.0, 36.0, color="#0072b2", alpha=0.12, zorder=0)
    axes.text(10.5, 34.3, "24 to 36 °C", fontsize=9)
    axes.set(
        xlabel="surface temperature [°C]", ylabel="apparent temperature [°C]", xlim=(10, 60), ylim=(10, 60)
    )
    axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(0.1, 1.0))
    return figure


def finely() -> Figure:
    """Draw three people in plain and in full detail, in the thermal and the colour image."""
    titles = [
        f"{camera}, detail: {detail}" for camera in ("thermal", "colour") for detail in get_args(Detail)
    ]
    figure, axes = panels(titles, 2.35)
    for column, detail in enumerate(get_args(Detail)):
        with SimulatedWorld(_three(detail)) as world:
            for _ in range(6):
                world.step(0.0, 0.0)
            images = dict(world.observe().images)
        show(axes[column], images["thermal_c"], cmap="gray", vmin=18.0, vmax=35.5)
        show(axes[2 + column], images["colour"])
    return figure


def _three(detail: Detail) -> WorldConfig:
    """Return a scene of a man and two women who walk towards the robot, with noise-free cameras."""
    people = tuple(
        PersonConfig(
            name=name,
            path=(Waypoint(at_m=at_m), Waypoint(at_m=(1.5, 0.5 * at_m[1]))),
            clothes=clothes,
            sex=sex,
            height_m=height_m,
        )
        for name, at_m, sex, height_m, clothes in _THREE
    )
    camera = Pinhole(width=240, height=183, vertical_fov_rad=math.radians(27.0))
    thermal = ThermalConfig(camera=camera, netd_k=0.0, fixed_pattern_k=0.0, dead_pixels=0.0)
    colour = ColourConfig(camera=camera, read_noise=0.0, shot_noise=0.0)
    return WorldConfig(
        place=build_place(straight_corridor(20.0, 6.0)),
        people=people,
        robot=RobotConfig(at_m=(0.8, 0.0), cameras={"thermal": thermal, "colour": colour}),
        seed=12,
        detail=detail,
    )


def apparent_c(true_c: NDArray[np.float64], emissivity: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the apparent temperature of surfaces (N,) [degC] in a room, by the renderer's radiance model."""
    radiance = emissivity * band_radiance(true_c)
    radiance += (1.0 - emissivity) * band_radiance(np.array([ROOM_C]))
    table = np.linspace(-40.0, 160.0, 4001)
    return np.interp(radiance, band_radiance(table), table)


def _surfaces() -> dict[str, tuple[float, float]]:
    """Return temperature [degC] and emissivity of the surfaces in a scene."""
    found = {name: (SKIN_C[name], SKIN) for name in ("head", "hand")}
    for name in ("t_shirt", "shirt", "wool_jumper", "fleece", "jacket"):
        found[name] = (TOPS[name].temperature_c, CLOTH)
    found["jeans"] = (BOTTOMS["jeans"].temperature_c, CLOTH)
    for name in ("ceiling_lamp", "radiator", "monitor", "robot", "table", "window"):
        found[name] = (KINDS[name].temperature_c, PAINT)
    return found


def gains() -> Figure:
    """Draw one scene with each gain, and with processing for display."""
    titles = ("gain: fixed, 24..36 °C", "gain: percentile", "gain: plateau", "thermal_scene, for display")
    figure, axes = panels(titles, 2.0)
    take = _camera()
    show(axes[0], take(_USUAL))
    show(axes[1], take(replace(_USUAL, gain="percentile")))
    show(axes[2], take(_PLATEAU))
    show(axes[3], take(_USUAL, show_scene))
    return figure


def faults() -> Figure:
    """Draw a part of the scene without and with each fault."""
    told: dict[str, dict[str, Any]] = {
        "none": {},
        "column_noise_k: 0.2": {"column_noise_k": 0.2},
        "vignetting_k: 1.5": {"vignetting_k": 1.5},
        "drift of 2 K/min, after 1 min": {"offset_drift_k_per_min": 2.0},
        "sharpening: 1.5": {"sharpening": 1.5},
        "jpeg_quality: 15": {"jpeg_quality": 15},
    }
    figure, axes = panels(tuple(told), 3.4, columns=3)
    take = _camera()
    for panel, keys in zip(axes, told.values(), strict=True):
        show(panel, take(replace(_PLATEAU, **keys)))
    return figure


def _camera() -> Callable[..., Grey]:
    """Return a camera that forms an image of a scene, with given settings."""
    with world_at("crossing_2", 0, 3.0) as world:
        config = world.config.robot.cameras["thermal"]
        assert isinstance(config, ThermalConfig)
        apparent = surface_image(replace(world._camera_view(config), turn_rad_s=0.0), config)

    def take(settings: ThermalConfig, encode: Callable[[NDArray[np.float32]], Grey] | None = None) -> Grey:
        detector = make_detector(settings, stream(0, "thermal.detector"))
        drift_k = Drift(settings, "thermal", 0).offset_k(_DRIFT_S)
        temperature = detect(apparent, detector, settings, stream(0, "thermal.noise"), drift_k)
        crisp = sharpen(temperature, settings.sharpening, settings.sharpening_px, settings.coring_k)
        grey = Gain(settings).grey(crisp, 0.0) if encode is None else encode(crisp)
        coarse = compress(grey, settings.jpeg_quality) // _STEP * _STEP
        return np.asarray(coarse, np.uint8)[40:200, 60:]

    return take
