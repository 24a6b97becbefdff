"""Pictures of the panoramic trackers: a panorama with tracks, and the handover to the thermal image."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Rectangle
from numpy.typing import NDArray

from docs.generate.pictures.paper import WIDTH_IN, show
from peopleboy.behaviours.scripted import Stand
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.drawing.plan_paths import draw_robot
from peopleboy.scenarios.drawing.plan_sheet import Labels, draw_floor, draw_walls
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.sim.world import SimulatedWorld
from peopleboy.studies.training.panorama_sequences import panorama_calibration, render_panoramas
from peopleboy.tracker.frame import PANORAMA, THERMAL, Frame
from peopleboy.tracker.sensors.panorama.figure_patch import ACROSS, BOTTOM_M, HALF_WIDTH_M, LAYERS, TOP_M, UP
from peopleboy.tracker.sensors.panorama.panorama_patches import PanoramaScene
from peopleboy.tracker.sensors.panorama.panorama_sensor import PanoramaExplanation
from peopleboy.tracker.sensors.panorama.people_foreground import Foreground
from peopleboy.tracker.track import FloorPlace, Status, Track
from peopleboy.tracker.trackers import explanation_of, make_tracker

DRIVE = ("panoramic_moving", 0)
"""Scenario and seed of the panorama: three people, and a driving robot."""

IMAGE = 304
REACH_M = 5.0
COLOURS = ("#0072b2", "#d55e00", "#cc79a7", "#009e73")
ROUND = ("panoramic_round", 0)
"""Scenario and seed of the handover: anna walks around the robot, bert waits."""

EVERY = 5  # frames
SURE = 2.45  # half axes of a 95 % ellipse, in standard deviations


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """One panorama, and the tracker's results.

    Attributes:
        explanation: the tracker's background and foreground.
        scene: explanation of the same image without people.
        tracks: the tracks.
        true_m: (P, 2) true positions of people in the robot's frame; NaN for absent people.
    """

    explanation: PanoramaExplanation
    scene: PanoramaScene
    tracks: tuple[Track, ...]
    true_m: NDArray[np.float64]


def all_round() -> Figure:
    """Draw a panorama, its background, foreground, the patch of one person, and the floor."""
    moment = _moment()
    figure = Figure((WIDTH_IN, 5.9), layout="constrained")
    left, right = figure.subfigures(1, 2, squeeze=False, width_ratios=(1.75, 1.0)).flat
    images = left.subplots(3, 1)
    titles = ("panorama with tracks", "background model", "foreground probability")
    pictures: tuple[NDArray[Any], ...] = (
        moment.scene.image,
        moment.explanation.background,
        moment.explanation.foreground,
    )
    for axes, title, picture in zip(images, titles, pictures, strict=True):
        show(axes, picture, cmap="gray")
        axes.set_title(title, fontsize=11)
        axes.set_axis_off()
    height, width = moment.scene.foreground.shape
    images[0].set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5))
    for track in moment.tracks:
        _boxed(images[0], track, width)
    above, below = right.subfigures(2, 1, squeeze=False, height_ratios=(1.75, 1.0)).flat
    _floor(above.subplots(), moment)
    _patches(below, moment)
    return figure


def handed_over() -> Figure:
    """Draw positions and ids of the tracks of a person who walks around the robot, for two trackers."""
    figure = Figure((WIDTH_IN, 5.4), layout="constrained")
    for axes, name in zip(figure.subplots(1, 2, sharey=True), ("handover", "contour"), strict=True):
        _way_round(axes, name)
    return figure


def _moment() -> Moment:
    """Run the tracker on a drive, up to one image."""
    name, seed = DRIVE
    scenario = load_scenario(name)
    film, camera = render_panoramas(scenario, seed), panorama_calibration(scenario, seed)
    tracker, eyes = make_tracker("panoramic"), Foreground()
    for k, image in enumerate(film.images[: IMAGE + 1]):
        time_s, moved = float(film.time_s[k]), film.odometry(k)
        frame = Frame(
            images={PANORAMA: image}, calibrations={PANORAMA: camera}, time_s=time_s, odometry=moved
        )
        tracks = tracker.update(frame)
        foreground = eyes.update(image, time_s, moved, camera)
    explanation = explanation_of(tracker)
    assert isinstance(explanation, PanoramaExplanation)
    scene = PanoramaScene.of(image, foreground, eyes.novelty, camera)
    return Moment(explanation, scene, tracks, film.place_m[k])


def colour_of(track: Track) -> str:
    """Return the colour in which a track is drawn."""
    return COLOURS[track.id % len(COLOURS)]


def _boxed(axes: Axes, track: Track, width: int) -> None:
    """Draw a box, on both sides if it crosses the seam."""
    left, top, wide, high = track.boxes[PANORAMA]
    for shift in (0.0, -width):
        corner = (left + shift - 0.5, top - 0.5)
        axes.add_patch(Rectangle(corner, wide, high, fill=False, edgecolor=colour_of(track), linewidth=1.6))


def _floor(axes: Axes, moment: Moment) -> None:
    """Draw positions with their 95 % ellipses; the robot is in the middle and faces up."""
    axes.set_title("floor, 95 % confidence ellipses", fontsize=11)
    axes.plot(0.0, 0.0, marker="^", color="0.4", markersize=9)
    axes.plot(-moment.true_m[:, 1], moment.true_m[:, 0], "k+", markersize=5, label="ground truth", zorder=3)
    for track in moment.tracks:
        axes.add_patch(place_ellipse(track))
    axes.set(xlim=(-REACH_M, REACH_M), ylim=(-REACH_M, REACH_M), aspect="equal")
    axes.set_xlabel("right [m]", fontsize=9)
    axes.set_ylabel("forward [m]", fontsize=9)
    axes.legend(loc="lower left", fontsize=9)


def place_ellipse(track: Track) -> Ellipse:
    """Return the ellipse that holds the position of a track with 95 % probability, seen from above."""
    assert track.place is not None
    (x, y), (xx, xy, yy) = track.place.position_m, track.place.covariance_m2
    variances, axes = np.linalg.eigh(np.array([[yy, -xy], [-xy, xx]]))  # x right, y ahead
    along, across = 2.0 * SURE * np.sqrt(variances[::-1])
    angle = math.degrees(math.atan2(axes[1, 1], axes[0, 1]))
    colour = colour_of(track)
    return Ellipse((-y, x), along, across, angle=angle, fill=False, edgecolor=colour, linewidth=2.0)


def _patches(figure: Figure, moment: Moment) -> None:
    """Draw the three layers of the patch at the estimated position of the nearest person."""
    nearest = min(moment.tracks, key=_distance_m)
    assert nearest.place is not None
    x, y = nearest.place.position_m
    polar = np.array([math.atan2(y, x)]), np.array([math.hypot(x, y)])
    layers = moment.scene.figures.patches(*polar)[0].reshape(LAYERS, UP, ACROSS)
    span = (-HALF_WIDTH_M, HALF_WIDTH_M, BOTTOM_M, TOP_M)
    panels = figure.subplots(1, LAYERS, sharey=True)
    for axes, layer, title in zip(panels, layers, ("foreground", "differs", "not covered"), strict=True):
        axes.imshow(layer, cmap="gray", vmin=0.0, vmax=1.0, extent=span, interpolation="nearest")
        axes.axhline(0.0, color=colour_of(nearest), linewidth=1.0)
        axes.set_title(title, fontsize=11)
        axes.set_xticks((-0.4, 0.0, 0.4))
        axes.tick_params(labelsize=8)
    panels[0].set_ylabel("height [m]", fontsize=9)
    panels[1].set_xlabel("lateral [m]", fontsize=9)


def _distance_m(track: Track) -> float:
    assert track.place is not None
    return math.hypot(*track.place.position_m)


def _way_round(axes: Axes, name: str) -> None:
    """Draw the room with the positions of tracks; solid marks are tracked in the thermal image, too."""
    scenario, (_, seed) = load_scenario(ROUND[0]), ROUND
    config = scenario.world(seed)
    labels = Labels(axes)
    draw_floor(axes, scenario.plan)
    draw_walls(axes, labels, scenario.place)
    draw_robot(axes, labels, scenario, config.robot)
    numbers = set()
    for track, place, is_warm in _spots(scenario, seed, name):
        colour = "#{:02x}{:02x}{:02x}".format(*track_colour(track))
        face = colour if is_warm else "white"
        axes.plot(*place, "o", color=colour, markerfacecolor=face, markersize=5, zorder=7)
        numbers.add(track)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.margins(0.02)
    axes.set_title(f"--tracker {name}: identities {', '.join(map(str, sorted(numbers)))}", fontsize=11)


def _spots(scenario: Scenario, seed: int, name: str) -> Iterator[tuple[int, tuple[float, float], bool]]:
    """Yield id, position, and presence in the thermal image of tracks every third of a second."""
    config = scenario.world(seed)
    frames = round(scenario.duration_s * config.control_hz)
    with SimulatedWorld(config) as world:
        tracker = make_tracker(name, seed)
        for tick in closed_loop(world, tracker, Stand(), frames):
            for track in tick.tracks if tick.frame % EVERY == 0 else ():
                if track.status in (Status.TRACKED, Status.PARTLY_OCCLUDED) and track.place is not None:
                    yield track.id, _in_room(track.place, tick.truth.robot), THERMAL in track.boxes


def _in_room(place: FloorPlace, robot: Pose2) -> tuple[float, float]:
    (ahead, left), (c, s) = place.position_m, (math.cos(robot.heading), math.sin(robot.heading))
    return robot.x + c * ahead - s * left, robot.y + s * ahead + c * left
