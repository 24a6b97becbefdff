"""Draw the figures of the 2003 paper on a panoramic camera, and errors over the distance."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.cameras.camera_config import PanoramaConfig
from peopleboy.sim.geometry.panorama import Mirror
from peopleboy.sim.world_config import WorldConfig
from peopleboy.studies.reproductions.canvas import (
    BLACK,
    BLUE,
    ORANGE,
    canvas,
    label,
    show_image,
    single,
)
from peopleboy.studies.reproductions.experiments.distance_trials import (
    SplitTrial,
    filtered,
    predicted_in_turn,
)
from peopleboy.studies.reproductions.experiments.panoramic_room import CUES, measure_walk, walks_of
from peopleboy.studies.reproductions.experiments.webcam_positions import (
    HEADING,
    RANGE,
    SCENE,
    X,
    Y,
    hat_column,
    true_webcams,
    webcam_names,
)
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.studies.training.distance import DistanceSamples, panoramas
from peopleboy.tracker.reproductions.panoramic.depth_cues import (
    EMPTY_IMAGES,
    Background,
    MeasuredFigure,
    learn_background,
    measure,
)
from peopleboy.tracker.reproductions.panoramic.paper_tracker import PanoramicConfig
from peopleboy.tracker.reproductions.panoramic.position_filter import PRINTED, PositionFilter

Floats = NDArray[np.float64]
Picture = NDArray[np.uint8]

ROOM: Final = "room_long"
_RED: Final = "#d64541"
_BODY, _PERSON = "#9aa3ad", "#cfd8c8"
_PEOPLE: Final = (BLUE, ORANGE)
_ROOMS: Final = (BLUE, ORANGE, "#66a61e")
_SET_UP_S, _FEATURES_S, _WEBCAMS_S = 8.0, 12.0, 3.0  # times of the images of figures 1, 4 and 2
_FARTHEST_M: Final = 6.0
_STEP_M: Final = 0.05  # of the floor plan
_FRAGMENT: Final = slice(60, 110)  # images of a clip: about 17 s
_CLASS_M, _LEAST = 0.5, 30  # width of a bin of distances, and its minimum number of images


def draw_set_up() -> Figure:
    """Draw lens, mirror and lines of sight from the side, and the round image of the lens."""
    page = canvas(2.5)
    side, close, raw = page.subplots(1, 3, gridspec_kw={"width_ratios": (1.6, 0.8, 1)})
    mirror = PanoramaConfig().camera.mirror
    _draw_side(side, mirror)
    _draw_mirror(close, mirror)
    show_image(raw, _round_image(), "image of the lens")
    return page


def _draw_side(axes: Axes, mirror: Mirror) -> None:
    """Draw the robot, a person, and the steepest and the flattest line of sight."""
    axes.add_patch(Rectangle((-0.2, 0.0), 0.4, 1.2, color=_BODY))
    axes.add_patch(Rectangle((-0.03, 1.2), 0.06, mirror.apex_m - 1.2, color=_BODY))
    steep, flat = mirror.axis_rad, mirror.axis_rad - mirror.lens_half_angle_rad
    top = mirror.ring_height_m
    for angle in (steep, flat):
        reach = min(top / math.tan(angle), _FARTHEST_M)
        axes.plot([0.0, reach], [top, top - reach * math.tan(angle)], color=ORANGE)
    axes.add_patch(Rectangle((3.0 - 0.18, 0.0), 0.36, 1.5, color=_PERSON))
    axes.add_patch(Rectangle((3.0 - 0.1, 1.52), 0.2, 0.23, color=_PERSON))
    axes.axhline(0.0, color="black", linewidth=0.8)
    axes.set_xlim(-0.5, _FARTHEST_M)
    axes.set_ylim(-0.1, 2.0)
    words = f"{math.degrees(flat):.0f} to {math.degrees(steep):.0f} deg below the horizon"
    label(axes, f"{words}, from {top:.2f} m", "m", "m", is_plan=True)


def _draw_mirror(axes: Axes, mirror: Mirror) -> None:
    """Draw the cone over the lens, and its reflection of the rays."""
    radius = 0.09
    top = mirror.apex_m + radius / math.tan(mirror.half_apex_rad)
    axes.add_patch(Polygon([(0.0, mirror.apex_m), (radius, top), (-radius, top)], color=BLUE, alpha=0.6))
    lens = mirror.apex_m - mirror.lens_m
    axes.plot(0.0, lens, "ko", markersize=5)
    for angle in np.linspace(0.12, 0.98, 4) * mirror.lens_half_angle_rad:
        x, y = _met(mirror, float(angle))
        down = mirror.axis_rad - angle
        ray = ([0.0, x, x + 0.1 * math.cos(down)], [lens, y, y - 0.1 * math.sin(down)])
        axes.plot(*ray, color=ORANGE, linewidth=1.0)
    axes.set_xlim(-0.1, 0.16)
    label(axes, "cone and lens", "m", "", is_plan=True)


def _met(mirror: Mirror, angle: float) -> tuple[float, float]:
    """Return the point x, y [m] where a ray at an angle [rad] from the lens axis meets the mirror."""
    # x = (y - lens) tan(angle) and x = (y - apex) tan(half apex)
    spread, side = math.tan(angle), math.tan(mirror.half_apex_rad)
    y = (mirror.apex_m * side - (mirror.apex_m - mirror.lens_m) * spread) / (side - spread)
    return (y - mirror.apex_m) * side, y


def _round_image() -> Picture:
    config = load_scenario(ROOM).world(0)
    cameras = {**config.robot.cameras, "panorama": PanoramaConfig(raw=True)}
    config = replace(config, robot=replace(config.robot, cameras=cameras))
    return np.asarray(_images_after(config, _SET_UP_S)["panorama_raw"], np.uint8)


def _images_after(config: WorldConfig, time_s: float) -> Mapping[str, Picture]:
    """Return the images of a world with a standing robot after some time [s]."""
    from peopleboy.sim.world import SimulatedWorld  # here, as curves of stored results need no PyBullet

    with SimulatedWorld(config) as world:
        for _ in range(round(time_s * config.control_hz)):
            world.step(0.0, 0.0)
        return dict(world.observe().images)


def draw_features() -> Figure:
    """Run the start of a scenario; draw a panorama, the difference from the background, and the cues."""
    scenario = load_scenario(ROOM)
    images = [image for image, _ in panoramas(scenario.world(0), _FEATURES_S)]
    background = learn_background(images[:EMPTY_IMAGES])
    figure = measure(background.silhouette(images[-1]), PanoramicConfig().least_px)
    if figure is None:
        raise BadInput(f"{ROOM}: no person is visible at {_FEATURES_S:g} s")
    return _drawn(images[-1], background, figure)


def _drawn(image: Picture, background: Background, found: MeasuredFigure) -> Figure:
    page = canvas(7.2)
    grid = page.subplots(4, 2, height_ratios=(1, 1, 0.45, 1), width_ratios=(1, 0.13))
    for axes in (grid[0, 1], grid[2, 1], grid[3, 1]):
        axes.set_axis_off()
    style: dict[str, Any] = {"cmap": "gray", "interpolation": "nearest", "aspect": "auto"}
    show_image(grid[0, 0], image, "a) panorama: the robot's back, left, front, right, and back", **style)
    difference = np.abs(image.astype(np.float64) - background.mean).max(axis=2)
    title = "b) difference from the background, and histograms of rows and columns"
    show_image(grid[1, 0], difference, title, **style)
    grid[1, 1].barh(np.arange(len(found.rows)), found.rows, 1.0, color=BLUE)
    grid[1, 1].set_ylim(len(found.rows) - 0.5, -0.5)
    grid[2, 0].bar(np.arange(len(found.columns)), found.columns, 1.0, color=BLUE)
    grid[2, 0].set_xlim(-0.5, len(found.columns) - 0.5)
    for axes in (grid[1, 1], grid[2, 0]):
        label(axes)
    cues, bearing = found.cues, np.degrees(found.bearing_rad)
    title = (
        f"c) pixels above the threshold: width {cues.width_px:.0f} px, {cues.gap_px:.0f} px to the bottom, "
        f"{cues.area_px:.0f} px in all, {abs(bearing):.1f} deg to the {'left' if bearing > 0.0 else 'right'}"
    )
    show_image(grid[3, 0], background.silhouette(image), title, **style)
    _mark(grid[3, 0], found)
    return page


def _mark(axes: Axes, found: MeasuredFigure) -> None:
    """Draw the person's box, the mean column, and the distance to the lower border."""
    left, top, width, height = found.box
    right, bottom, border = left + width, top + height, len(found.rows) - 0.5
    axes.plot([left, right, right, left, left], [top, top, bottom, bottom, top], color=ORANGE, linewidth=1.0)
    axes.plot([found.mean_column] * 2, [top, bottom], color=ORANGE, linewidth=0.8, linestyle=":")
    arrow = {"arrowstyle": "<->", "color": ORANGE}
    axes.annotate("", (right + 6, border), (right + 6, bottom), arrowprops=arrow)


def draw_webcam_images() -> Figure:
    """Draw the images of the four webcams at one instant, and the detected hat."""
    config = load_scenario(SCENE).world(0)
    names = webcam_names(config)
    images = _images_after(config, _WEBCAMS_S)
    figure = canvas(4.4, 5.6)
    for axes, name in zip(figure.subplots(2, 2).flat, names, strict=True):
        column = hat_column(images[name])
        place = "not fully visible" if column is None else f"at column {column:.1f}"
        show_image(axes, images[name], f"{name}: hat {place}")
        if column is not None:
            axes.axvline(column, color=ORANGE, linewidth=1.0)
    return figure


def draw_fields_of_view() -> Figure:
    """Draw the floor plan with webcams and robot, shaded by the number of webcams that see a place."""
    scenario = load_scenario(SCENE)
    config = scenario.world(0)
    webcams = true_webcams(config, webcam_names(config))
    floor = scenario.plan.bounds()
    low_x, low_y, high_x, high_y = floor.min_x, floor.min_y, floor.max_x, floor.max_y
    x, y = np.meshgrid(np.arange(low_x, high_x, _STEP_M), np.arange(low_y, high_y, _STEP_M))
    seen = sum(
        np.abs(np.angle(np.exp(1j * (np.arctan2(y - one[Y], x - one[X]) - one[HEADING])))) < one[RANGE] / 2.0
        for one in webcams
    )
    figure, axes = single(4.6)
    style: dict[str, Any] = {"cmap": "Greens", "shading": "nearest", "rasterized": True}
    drawn = axes.pcolormesh(x, y, seen, vmin=-0.5, vmax=4.5, **style)
    figure.colorbar(drawn, ax=axes, ticks=range(5), label="webcams in view", shrink=0.8)
    axes.plot(webcams[:, X], webcams[:, Y], "o", color=ORANGE, markersize=9)
    axes.add_patch(Rectangle((low_x, low_y), high_x - low_x, high_y - low_y, fill=False, linewidth=1.5))
    axes.plot(*config.robot.at_m, "s", color=_RED, markersize=10)
    axes.annotate("robot", config.robot.at_m, (10, -2), textcoords="offset points", fontsize=8, color="white")
    label(axes, "", "m", "m", is_plan=True)
    return figure


def draw_correlations(using: Measurement) -> Figure:
    """Draw each cue of the first run, and the network's estimate, over the true distance: figure 5."""
    run = walks_of(using)[ROOM][0]
    predicted = predicted_in_turn(run, SplitTrial(split="random"))
    figure = canvas(5.6)
    for axes, name, values in zip(figure.subplots(2, 2).flat, CUES, (*run.cues.T, predicted), strict=True):
        for person, colour in zip(np.unique(run.person).tolist(), _PEOPLE, strict=False):
            one = run.person == person
            style: dict[str, Any] = {"markersize": 2.5, "color": colour, "label": f"person {person}"}
            axes.plot(run.distance_m[one], values[one], ".", **style)
        r = np.corrcoef(values, run.distance_m)[0, 1]
        label(axes, f"{name}: r = {r:.3f}", "true distance [m]", "m" if values is predicted else "px")
    figure.axes[0].legend(fontsize=7, frameon=False, markerscale=3)
    return figure


def draw_path(using: Measurement) -> Figure:
    """Draw a section of a path on the floor: true, by the model alone, and with the filter (figure 6)."""
    (first,) = using.results([Unit.of(measure_walk, ROOM, 0)])
    run = DistanceSamples.from_plain(first)
    measured = run.positions_at(predicted_in_turn(run, SplitTrial(split="blocks")))
    smooth = filtered(run, measured, PositionFilter(PRINTED, uses_velocity=True))
    figure, axes = single(4.6)
    for name, place, colour, style, width in (
        ("true", run.true_m, BLACK, "-", 2.0),
        ("appearance model", measured, ORANGE, "x-", 0.6),
        ("with Kalman filter", smooth, BLUE, "o-", 1.2),
    ):
        x, y = place[_FRAGMENT].T
        axes.plot(-y, x, style, color=colour, linewidth=width, markersize=3, label=name)
    axes.plot(0.0, 0.0, "s", color=_RED, markersize=9)
    axes.annotate("robot", (0.0, 0.0), (8, 6), textcoords="offset points", fontsize=8)
    label(axes, "", "to the robot's right [m]", "ahead [m]", is_plan=True, legend=8)
    return figure


def draw_ranges(using: Measurement) -> Figure:
    """Draw the mean error of the distance over the distance, by room, from test images only."""
    figure, axes = single(3.4)
    for (room, runs), colour in zip(walks_of(using).items(), _ROOMS, strict=False):
        distance = np.concatenate([run.distance_m for run in runs])
        errors = np.concatenate(
            [np.abs(predicted_in_turn(run, SplitTrial(split="blocks")) - run.distance_m) for run in runs]
        )
        middles, means, spreads = error_by_range(distance, errors)
        axes.plot(middles, means, "o-", color=colour, markersize=4, label=room)
        least, most = np.maximum(means - spreads, 0.0), means + spreads
        axes.fill_between(middles, least, most, color=colour, alpha=0.12, linewidth=0)
    axes.set_ylim(bottom=0.0)
    axes.grid(axis="y", linewidth=0.4, alpha=0.6)
    label(axes, "", "true distance [m]", "error of the distance [m]", legend=8, loc="upper left")
    return figure


def error_by_range(distance_m: Floats, errors_m: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the centres [m] of bins of distances, and mean and deviation of their errors, each (K,)."""
    number = np.floor(distance_m / _CLASS_M).astype(np.int64)
    known = [k for k in np.unique(number).tolist() if np.count_nonzero(number == k) >= _LEAST]
    return (
        (np.array(known, np.float64) + 0.5) * _CLASS_M,
        np.array([errors_m[number == k].mean() for k in known]),
        np.array([errors_m[number == k].std() for k in known]),
    )
