"""Picture of people detection in depth: floor and ceiling, plan view, and clusters of human size."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from docs.generate.pictures.paper import show
from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.cameras.depth import show_depth
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame
from peopleboy.tracker.sensors.depth.depth_sensor import DepthExplanation
from peopleboy.tracker.sensors.depth.depth_view import DepthView
from peopleboy.tracker.sensors.depth.pre_detection import PreDetection
from peopleboy.tracker.sensors.depth.u_depth import FARTHEST_M, depths_m
from peopleboy.tracker.sensors.depth.v_disparity import BIN_PX, HeightLine, v_disparity
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import explanation_of, make_tracker

SCENARIO, SEED, AT_S = "crowd_8_moving", 0, 5.0
NEAREST_M = 1.5
FOUND, LINE = "#1b9e77", "#d95f02"


def steps() -> Figure:
    """Draw colour with tracks, depth with detections, the v-disparity image, and the plan view."""
    frame, view, tracks, explanation = _watch()
    figure = Figure(figsize=(7.6, 5.9), layout="constrained")
    (colour, depth), (rows, above) = figure.subplots(2, 2)
    show(colour, frame.rgb(DEPTH_COLOUR))
    colour.set_title("tracks", fontsize=9)
    for track in tracks:
        _draw(colour, track.boxes[DEPTH], tuple(c / 255 for c in track_colour(track.id)), str(track.id))
    show(depth, show_depth(frame.depth(DEPTH)))
    depth.set_title("human size; solid: verified", fontsize=9)
    for one, score in _detected(explanation):
        _draw(depth, one.box, FOUND, "", dashed=score <= 0.0)
    _draw_rows(rows, frame, view, explanation)
    _draw_above(above, view, explanation)
    return figure


def _watch() -> tuple[Frame, DepthView, tuple[Track, ...], DepthExplanation]:
    scenario = load_scenario(SCENARIO).mounting((DEPTH,))
    calibrations = calibrations_of(scenario.world(SEED).robot.cameras)
    tracker = make_tracker("rgbd", SEED)
    for _, observation in blind_drive(scenario, SEED):
        images = {name: observation.images[name] for name in (DEPTH, DEPTH_COLOUR)}
        frame = Frame(images=images, time_s=observation.time_s, calibrations=calibrations)
        tracks = tracker.update(frame)
        if observation.time_s >= AT_S:
            break
    explanation = explanation_of(tracker)
    assert isinstance(explanation, DepthExplanation)
    return frame, DepthView.of(calibrations[DEPTH], DEPTH), tracks, explanation


def _detected(explanation: DepthExplanation) -> list[tuple[PreDetection, float]]:
    """Return the objects of human size, with their log-odds of being people."""
    return list(zip(explanation.layout.detections, explanation.scores.tolist(), strict=False))


def _draw(axes: Axes, box: tuple[float, ...], colour: object, text: str, *, dashed: bool = False) -> None:
    left, top, width, height = box
    style = "--" if dashed else "-"
    axes.add_patch(Rectangle((left, top), width, height, fill=False, edgecolor=colour, lw=1.3, ls=style))
    axes.text(left, top - 6, text, color=colour, fontsize=8, clip_on=True)


def _draw_rows(axes: Axes, frame: Frame, view: DepthView, explanation: DepthExplanation) -> None:
    """Draw rows over disparity: the floor is a falling line, the ceiling rises, people are vertical."""
    counts = v_disparity(frame.depth(DEPTH), view)
    last = int(view.disparity_px_m / NEAREST_M / BIN_PX)
    axes.imshow(
        np.log1p(counts[:, :last]), cmap="gray_r", aspect="auto", extent=(0, last * BIN_PX, 479.5, -0.5)
    )
    depth_m = np.linspace(NEAREST_M, FARTHEST_M, 200)
    for line in (explanation.layout.floor, explanation.layout.ceiling):
        if isinstance(line, HeightLine):
            axes.plot(view.disparity_px_m / depth_m, line.rows(depth_m, view), color=LINE, lw=1.2)
    axes.set(xlim=(0, last * BIN_PX), ylim=(479.5, -0.5), xlabel="disparity (px)", ylabel="row")
    axes.set_title("v-disparity: floor and ceiling", fontsize=9)


def _draw_above(axes: Axes, view: DepthView, explanation: DepthExplanation) -> None:
    """Draw columns over depth, between floor, ceiling and walls, which are lines in disparity."""
    counts = explanation.layout.counts
    depth_m = depths_m(FARTHEST_M / (len(counts) - 1))
    extent = (-0.5, counts.shape[1] - 0.5, 0.0, float(depth_m[-1]))
    axes.imshow(np.log1p(counts), cmap="gray_r", aspect="auto", origin="lower", extent=extent)
    for wall in explanation.layout.walls:
        columns = np.arange(wall.left, wall.right + 1.0)
        axes.plot(columns, wall.depth_m(columns, view), color=LINE, lw=1.2)
    for one, score in _detected(explanation):
        left, _, width, _ = one.box
        low = one.z_m - one.depth_m / 2.0
        _draw_flat(axes, (left, low, width, one.depth_m), dashed=score <= 0.0)
    axes.set(xlim=extent[:2], ylim=(NEAREST_M, 10.0), xlabel="column", ylabel="depth (m)")
    axes.set_title("plan view: walls and clusters of human size", fontsize=9)


def _draw_flat(axes: Axes, box: tuple[float, ...], *, dashed: bool) -> None:
    left, low, width, depth = box
    style = "--" if dashed else "-"
    axes.add_patch(Rectangle((left, low), width, depth, fill=False, edgecolor=FOUND, lw=1.3, ls=style))
