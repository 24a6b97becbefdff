"""Picture of a scene model: its background, early and late, and moved objects."""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from docs.generate.pictures.paper import show
from peopleboy.scenarios.drawing.palette import person_colour, track_colour
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.studies.reproductions.experiments.scenes import with_preset
from peopleboy.tracker.frame import DEPTH_COLOUR, Frame
from peopleboy.tracker.scene_model.scene import Metres, VistaScene
from peopleboy.tracker.scene_model.scene_config import SceneConfig
from peopleboy.tracker.scene_model.scene_model import SceneModel

SCENARIO, SEED = "chairs_1", 0
TIMES_S = (2.0, 9.0, 21.0)
NEAREST_M, FARTHEST_M = 1.5, 6.5


def scenes() -> Figure:
    """Draw three instants: the image with people and objects marked, and the background model."""
    figure = Figure(figsize=(7.6, 4.1), layout="constrained")
    rows = figure.subplots(2, len(TIMES_S))
    for (above, below), (frame, scene) in zip(rows.T, _watch(), strict=True):
        show(above, _marked(frame, scene))
        above.set_title(f"{scene.time_s:.0f} s", fontsize=9)
        above.set_axis_off()
        for one in scene.persons:
            _name(above, scene.people == one.id, f"person {one.id}")
        for thing in scene.objects:
            _name(above, scene.things == thing.id, f"object {thing.id}")
        _draw_depth(below, scene.background_m)
    return figure


def _watch() -> list[tuple[Frame, VistaScene]]:
    scenario = with_preset(load_scenario(SCENARIO), "kinect")
    calibrations = calibrations_of(scenario.world(SEED).robot.cameras)
    model, before, found = SceneModel(SceneConfig()), None, []
    for _, observation in blind_drive(scenario, SEED):
        frame = Frame.from_observation(observation, before, calibrations)
        before = observation.odometry
        scene = model.update(frame)
        if any(abs(observation.time_s - time_s) < 1e-6 for time_s in TIMES_S):
            found.append((frame, scene))
    return found


def _marked(frame: Frame, scene: VistaScene) -> np.ndarray[tuple[int, int, int], np.dtype[np.uint8]]:
    """Return the image (H, W, 3) with people and objects tinted."""
    image = frame.rgb(DEPTH_COLOUR).astype(np.float64)
    for labels, colour in ((scene.people, person_colour), (scene.things, track_colour)):
        for number in np.unique(labels[labels > 0]).tolist():
            image[labels == number] = 0.35 * image[labels == number] + 0.65 * np.array(colour(number))
    return np.rint(image).astype(np.uint8)


def _name(axes: Axes, mask: np.ndarray[tuple[int, int], np.dtype[np.bool_]], text: str) -> None:
    if mask.sum() > 100:
        rows, columns = np.nonzero(mask)
        is_left = columns.mean() < 0.53 * mask.shape[1]  # labels of neighbours would overlap
        place = columns.min() - 4 if is_left else columns.max() + 4
        side = "right" if is_left else "left"
        axes.text(place, rows.mean(), text, color="black", fontsize=7, ha=side, clip_on=True)


def _draw_depth(axes: Axes, depth_m: Metres) -> None:
    colours = colormaps["viridis_r"].with_extremes(bad="black")
    shown = np.ma.masked_equal(depth_m, 0.0)
    axes.imshow(shown, cmap=colours, vmin=NEAREST_M, vmax=FARTHEST_M, interpolation="nearest")
    axes.set_axis_off()
