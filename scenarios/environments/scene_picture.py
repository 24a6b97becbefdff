"""Draw a scene as one picture: thermal image, colour image, and the plan around the robot."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.drawing.overlay import Picture, draw_tracks, show_thermal
from peopleboy.scenarios.drawing.palette import ROBOT, Rgb, person_colour
from peopleboy.scenarios.drawing.plan_sheet import Labels, draw_floor, draw_things, draw_walls
from peopleboy.sim.observation import Observation
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.places.place import Place
from peopleboy.sim.robot.robot_body import RADIUS_M
from peopleboy.sim.truth.scenes import Bystander, ImageFreeTruth
from peopleboy.tracker.track import Track

WIDTH_PX, HEIGHT_PX = 480, 360  # of each of the three panels
_PX_PER_M = 40.0  # scale of the plan, which shows 12 x 9 m around the robot
_PAPER: Rgb = (251, 250, 247)
_PAPER_NAME = "#fbfaf7"
_SUBPIXEL_BITS = 4


class ScenePicture:
    """Draw one instant after another; the plan is drawn only once."""

    def __init__(self, plan: FloorPlan, place: Place) -> None:
        self._corner = np.array([place.bounds[0], place.bounds[3]])  # [m] of the plan's top-left pixel
        self._plan = _draw_place(plan, place)

    def draw(
        self, observation: Observation, scene: ImageFreeTruth, tracks: Sequence[Track], explanation: object
    ) -> Picture:
        """Draw an instant, with tracks and the tracker's explanation: (360, 1440, 3)."""
        thermal, colour = observation.images["thermal_scene"], observation.images["colour"]
        scale = HEIGHT_PX / thermal.shape[0]
        seen = draw_tracks(_fit(show_thermal(thermal)), tracks, scale, explanation)
        return np.concatenate((seen, _fit(colour), self._draw_plan(scene)), axis=1)

    def _draw_plan(self, scene: ImageFreeTruth) -> Picture:
        """Return the plan with the robot in the middle, north up, and all people who are present."""
        robot = scene.robot
        offset = np.array([WIDTH_PX, HEIGHT_PX]) / 2.0 - self._pixels((robot.x, robot.y))
        shift = np.array([[1.0, 0.0, offset[0]], [0.0, 1.0, offset[1]]])
        moved = cv2.warpAffine(self._plan, shift, (WIDTH_PX, HEIGHT_PX), borderValue=_PAPER)
        canvas = np.asarray(moved, np.uint8)
        for person in scene.people:
            _draw_person(canvas, self._pixels(person.position_m) + offset, person)
        _draw_robot(canvas, robot)
        return canvas

    def _pixels(self, point: tuple[float, float]) -> NDArray[np.float64]:
        """Return the pixel (2,) of a point in the whole plan."""
        pixels: NDArray[np.float64] = (np.array(point) - self._corner) * [_PX_PER_M, -_PX_PER_M]
        return pixels


def _draw_place(plan: FloorPlan, place: Place) -> Picture:
    """Draw the whole place from above, at `_PX_PER_M` pixels per metre."""
    min_x, min_y, max_x, max_y = place.bounds
    size = ((max_x - min_x) * _PX_PER_M / 100.0, (max_y - min_y) * _PX_PER_M / 100.0)
    figure = Figure(figsize=size, dpi=100, facecolor=_PAPER_NAME)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_xlim(min_x, max_x)
    axes.set_ylim(min_y, max_y)
    axes.set_axis_off()
    draw_floor(axes, plan)
    draw_walls(axes, Labels(axes), place)
    draw_things(axes, Labels(axes), place)
    canvas.draw()  # type: ignore[no-untyped-call]
    return np.asarray(canvas.buffer_rgba(), np.uint8)[:, :, :3].copy()  # type: ignore[no-untyped-call]


def _fit(image: Picture) -> Picture:
    """Scale an image to the panel's height, and crop or pad its width."""
    height, width = image.shape[:2]
    wide = round(width * HEIGHT_PX / height)
    scaled = cv2.resize(image, (wide, HEIGHT_PX), interpolation=cv2.INTER_NEAREST)
    panel = np.full((HEIGHT_PX, WIDTH_PX, 3), 30, np.uint8)
    shown = min(wide, WIDTH_PX)
    panel[:, :shown] = scaled[:, :shown]
    return panel


def _draw_person(canvas: Picture, centre: NDArray[np.float64], person: Bystander) -> None:
    colour = person_colour(person.id)
    _disc(canvas, centre, person.radius_m, (60, 60, 60), -1)
    _disc(canvas, centre, person.radius_m - 0.04, colour, -1)
    _needle(canvas, centre, person.heading_rad, person.radius_m, (60, 60, 60))
    at = (round(float(centre[0])) + 12, round(float(centre[1])) - 8)
    cv2.putText(canvas, person.name, at, cv2.FONT_HERSHEY_SIMPLEX, 0.4, (60, 60, 60), 1, cv2.LINE_AA)


def _draw_robot(canvas: Picture, robot: Pose2) -> None:
    centre = np.array([WIDTH_PX, HEIGHT_PX]) / 2.0
    _disc(canvas, centre, RADIUS_M, ROBOT, 2)
    _needle(canvas, centre, robot.heading, 1.5 * RADIUS_M, ROBOT)


def _disc(canvas: Picture, centre: NDArray[np.float64], radius_m: float, colour: Rgb, thickness: int) -> None:
    cv2.circle(
        canvas, _fixed(centre), round(radius_m * _PX_PER_M * (1 << _SUBPIXEL_BITS)), colour, thickness,
        cv2.LINE_AA, _SUBPIXEL_BITS,
    )  # fmt: skip


def _needle(
    canvas: Picture, centre: NDArray[np.float64], heading: float, length_m: float, colour: Rgb
) -> None:
    tip = centre + length_m * _PX_PER_M * np.array([math.cos(heading), -math.sin(heading)])
    cv2.line(canvas, _fixed(centre), _fixed(tip), colour, 2, cv2.LINE_AA, _SUBPIXEL_BITS)


def _fixed(point: NDArray[np.float64]) -> tuple[int, int]:
    """Return a pixel in OpenCV's fixed-point format."""
    x, y = np.round(point * (1 << _SUBPIXEL_BITS)).astype(int).tolist()
    return x, y
