"""Picture of the way of one frame through the tracking core."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from docs.generate.pictures.all_round import colour_of, place_ellipse
from docs.generate.pictures.moments import CROSSING
from docs.generate.pictures.paper import panels, show
from peopleboy.behaviours.scripted import Stand
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.sensors.thermal.thermal_sensor import ThermalSensor
from peopleboy.tracker.tracking.people_tracker import PeopleTracker
from peopleboy.tracker.tracking.sensor import Predictions, SensorDetections

MOST_FRAMES = 150
FARTHEST_M = 11.0
COLUMNS, ROWS = (75.0, 255.0), (239.5, 49.5)
HIDDEN_FRAMES = 5  # images after which an undetected person is clearly behind the other one
_TITLES = ("1. predicted tracks", "2. detections of a sensor", "3. updated states", "4. tracks of this frame")


class _WatchedSensor(ThermalSensor):
    """The thermal sensor, whose last detections can be drawn."""

    detections: SensorDetections | None = None

    def detect(self, frame: Frame, predicted: Predictions) -> SensorDetections | None:
        self.detections = super().detect(frame, predicted)
        return self.detections


def one_frame() -> Figure:
    """Draw predictions, detections, states and tracks in an image in which one person hides another."""
    tick, detections = _hidden_person()
    figure, axes = panels(_TITLES, 3.1)
    for panel in (axes[0], axes[1], axes[3]):
        show(panel, tick.observation.images[THERMAL])
        panel.set(xlim=COLUMNS, ylim=ROWS)
    _draw_boxes(axes[0], detections.expected, "#e69f00", [""] * len(detections.expected), linestyle="--")
    scores = [f"{score:+.1f}" for score in detections.scores]
    _draw_boxes(axes[1], detections.boxes, "#56b4e9", scores)
    _draw_floor(axes[2], tick)
    for track in tick.tracks:
        words = f"{track.id}: {track.status.value.replace('_', ' ')}"
        _draw_boxes(axes[3], [track.boxes[THERMAL]], colour_of(track), [words])
    return figure


def _hidden_person() -> tuple[Tick, SensorDetections]:
    """Return the moment at which one of two tracked people has been hidden for some images."""
    sensor, hidden = _WatchedSensor(), 0
    with SimulatedWorld(load_scenario(CROSSING[0]).world(CROSSING[1])) as world:
        for tick in closed_loop(world, PeopleTracker((sensor,)), Stand(), MOST_FRAMES):
            seen = sensor.detections
            is_hidden = seen is not None and len(seen.boxes) == 1 and len(tick.tracks) == 2
            hidden = hidden + 1 if is_hidden else 0
            if seen is not None and hidden == HIDDEN_FRAMES:
                return tick, seen
    raise AssertionError("no person is hidden")


def _draw_boxes(axes: Axes, boxes: Iterable[Any], colour: Any, words: list[str], **style: Any) -> None:
    for (left, top, width, height), text in zip(boxes, words, strict=True):
        axes.add_patch(
            Rectangle((left, top), width, height, fill=False, edgecolor=colour, linewidth=1.6, **style)
        )
        axes.text(left + width + 3, top + 8, text, color=colour, fontsize=8, clip_on=True)


def _draw_floor(axes: Axes, tick: Tick) -> None:
    """Draw 95 % ellipses of the tracks on the floor, and true places as crosses; the robot looks up."""
    for track in tick.tracks:
        if track.place is not None:
            axes.add_patch(place_ellipse(track))
            x, y = track.place.position_m
            axes.text(-y + 0.55, x, str(track.id), color=colour_of(track), fontsize=9, clip_on=True)
    for person in tick.truth.people:
        x, y = tick.truth.robot.to_local(person.position_m)
        axes.plot(-y, x, "x", color="black", markersize=6)
    axes.plot(0.0, 0.0, "^", color="0.4", markersize=9)
    axes.set(xlim=(-4.0, 4.0), ylim=(-0.5, FARTHEST_M), aspect="equal")
