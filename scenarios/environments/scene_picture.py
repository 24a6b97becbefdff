"""Draw a scene as one picture: thermal image, colour image, and the plan with robot, people and goal."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from peopleboy.scenarios.drawing.overlay import Picture, draw_tracks, show_thermal
from peopleboy.scenarios.drawing.palette import ROBOT, Rgb, person_colour
from peopleboy.scenarios.drawing.plan_sheet import Labels, draw_floor, draw_things, draw_walls
from peopleboy.scenarios.scores.goal_metrics import REACHED_M
from peopleboy.sim.observation import Observation
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.places.place import Place
from peopleboy.sim.robot.robot_body import RADIUS_M
from peopleboy.sim.truth.scenes import Bystander, ImageFreeTruth
from peopleboy.tracker.track import Track

WIDTH_PX, HEIGHT_PX = 480, 360  # of each of the three panels
_PX_PER_M = (30.0, 60.0)  # smallest and largest scale of the plan; in between, it shows the whole place
_PAPER: Rgb = (251, 250, 247)
_DARK: Rgb = (30, 30, 30)
_INK: Rgb = (60, 60, 60)
_FONT, _LETTER = cv2.FONT_HERSHEY_SIMPLEX, 0.42
_EDGE_PX = 6  # from texts to the edge of a panel
_TARGET_M = 0.2  # from a person's outline to the ring that marks the target
_PAPER_NAME = "#fbfaf7"
_SUBPIXEL_BITS = 4


class ScenePicture:
    """Draw one instant after another; the plan is drawn only once.

    Args:
        plan: floor plan.
        place: the place.
        goal_m: x, y [m] of the robot's goal; None for none.
        follows: whether the task is to follow the first person who is present, who is then marked.
    """

    def __init__(
        self, plan: FloorPlan, place: Place, goal_m: tuple[float, float] | None, *, follows: bool
    ) -> None:
        min_x, min_y, max_x, max_y = place.bounds
        self._corner = np.array([min_x, max_y])  # [m] of the plan's top-left pixel
        least, most = _PX_PER_M
        self._scale = min(max(min(WIDTH_PX / (max_x - min_x), HEIGHT_PX / (max_y - min_y)), least), most)
        self._plan = _draw_place(plan, place, self._scale)
        self._goal_m, self._follows = goal_m, follows
        if goal_m is not None:
            for radius_m in (REACHED_M, 0.1):
                self._disc(self._plan, self._pixels(goal_m), radius_m, ROBOT, 2)
            _write(self._plan, "goal", self._pixels(goal_m), REACHED_M * self._scale, ROBOT)

    def draw(
        self, observation: Observation, scene: ImageFreeTruth, tracks: Sequence[Track], explanation: object
    ) -> Picture:
        """Draw an instant, with tracks and the tracker's explanation: (360, 1440, 3)."""
        thermal, colour = observation.images["thermal_scene"], observation.images["colour"]
        scale = _scale_of(thermal)
        seen = draw_tracks(_enlarged(show_thermal(thermal), scale), tracks, scale, explanation)
        panels = {
            f"thermal, {thermal.shape[1]} x {thermal.shape[0]}": _padded(seen),
            f"colour, {colour.shape[1]} x {colour.shape[0]}": _padded(_enlarged(colour, _scale_of(colour))),
            f"{scene.time_s:.1f} s": self._draw_plan(scene),
        }
        for title, panel in panels.items():
            _title(panel, title)
        return np.concatenate(list(panels.values()), axis=1)

    def _draw_plan(self, scene: ImageFreeTruth) -> Picture:
        """Return the plan, or its part around the robot, north up, with all people who are present."""
        robot = scene.robot
        here, panel = self._pixels((robot.x, robot.y)), np.array([WIDTH_PX, HEIGHT_PX])
        size = np.array(self._plan.shape[1::-1])
        centred = (panel - size) / 2.0
        offset = np.where(size <= panel, centred, np.clip(panel / 2.0 - here, panel - size, 0.0))
        shift = np.array([[1.0, 0.0, offset[0]], [0.0, 1.0, offset[1]]])
        moved = cv2.warpAffine(self._plan, shift, (WIDTH_PX, HEIGHT_PX), borderValue=_PAPER)
        canvas = np.asarray(moved, np.uint8)
        target = scene.people[0] if self._follows and scene.people else None
        for person in scene.people:
            self._draw_person(canvas, self._pixels(person.position_m) + offset, person, person is target)
        self._disc(canvas, here + offset, RADIUS_M, ROBOT, 2)
        self._needle(canvas, here + offset, robot.heading, 1.5 * RADIUS_M, ROBOT)
        return canvas

    def _draw_person(
        self, canvas: Picture, centre: NDArray[np.float64], person: Bystander, is_target: bool
    ) -> None:
        colour, radius_m = person_colour(person.id), person.radius_m
        if is_target:
            self._disc(canvas, centre, radius_m + _TARGET_M, ROBOT, 2)
        self._disc(canvas, centre, radius_m, _INK, -1)
        self._disc(canvas, centre, radius_m - 0.04, colour, -1)
        self._needle(canvas, centre, person.heading_rad, radius_m, _INK)
        name = f"{person.name} (target)" if is_target else person.name
        around = (radius_m + is_target * _TARGET_M) * self._scale
        _write(canvas, name, centre, around, ROBOT if is_target else _INK)

    def _pixels(self, point: tuple[float, float]) -> NDArray[np.float64]:
        """Return the pixel (2,) of a point in the whole plan."""
        pixels: NDArray[np.float64] = (np.array(point) - self._corner) * [self._scale, -self._scale]
        return pixels

    def _disc(
        self, canvas: Picture, centre: NDArray[np.float64], radius_m: float, colour: Rgb, thickness: int
    ) -> None:
        radius = round(radius_m * self._scale * (1 << _SUBPIXEL_BITS))
        cv2.circle(canvas, _fixed(centre), radius, colour, thickness, cv2.LINE_AA, _SUBPIXEL_BITS)

    def _needle(
        self, canvas: Picture, centre: NDArray[np.float64], heading: float, length_m: float, colour: Rgb
    ) -> None:
        tip = centre + length_m * self._scale * np.array([math.cos(heading), -math.sin(heading)])
        cv2.line(canvas, _fixed(centre), _fixed(tip), colour, 2, cv2.LINE_AA, _SUBPIXEL_BITS)


def _draw_place(plan: FloorPlan, place: Place, scale: float) -> Picture:
    """Draw the whole place from above, at a scale [px/m]."""
    min_x, min_y, max_x, max_y = place.bounds
    size = ((max_x - min_x) * scale / 100.0, (max_y - min_y) * scale / 100.0)
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


def _scale_of(image: Picture) -> float:
    """Return the enlargement at which an image (H, W, ...) just fits into a panel."""
    height, width = map(int, image.shape[:2])
    return min(HEIGHT_PX / height, WIDTH_PX / width)


def _enlarged(image: Picture, scale: float) -> Picture:
    """Scale an image; enlarged pixels stay sharp, so that one sees what the robot does."""
    size = max(round(image.shape[1] * scale), 1), max(round(image.shape[0] * scale), 1)
    way = cv2.INTER_NEAREST if scale >= 1.0 else cv2.INTER_AREA
    return np.asarray(cv2.resize(image, size, interpolation=way), np.uint8)


def _padded(image: Picture) -> Picture:
    """Put an image in the middle of a dark panel."""
    panel = np.full((HEIGHT_PX, WIDTH_PX, 3), _DARK, np.uint8)
    top, left = (HEIGHT_PX - image.shape[0]) // 2, (WIDTH_PX - image.shape[1]) // 2
    panel[top : top + image.shape[0], left : left + image.shape[1]] = image
    return panel


def _title(panel: Picture, text: str) -> None:
    """Write a title on a dark plate at the bottom left of a panel."""
    (width, height), _ = cv2.getTextSize(text, _FONT, _LETTER, 1)
    low = HEIGHT_PX - height - 2 * _EDGE_PX
    cv2.rectangle(panel, (0, low), (width + 2 * _EDGE_PX, HEIGHT_PX), _DARK, -1)
    at = (_EDGE_PX, HEIGHT_PX - _EDGE_PX)
    cv2.putText(panel, text, at, _FONT, _LETTER, (255, 255, 255), 1, cv2.LINE_AA)


def _write(canvas: Picture, text: str, at: NDArray[np.float64], around: float, colour: Rgb) -> None:
    """Write a text with a light edge above a disc, or as near to that as the canvas allows."""
    (width, height), _ = cv2.getTextSize(text, _FONT, _LETTER, 1)
    room = np.array([canvas.shape[1] - width - _EDGE_PX, canvas.shape[0] - _EDGE_PX])
    wanted = at - np.array([width / 2.0, around + _EDGE_PX])
    left, low = np.clip(wanted, [_EDGE_PX, height + _EDGE_PX], room).astype(int).tolist()
    for shade, thickness in ((_PAPER, 3), (colour, 1)):
        cv2.putText(canvas, text, (left, low), _FONT, _LETTER, shade, thickness, cv2.LINE_AA)


def _fixed(point: NDArray[np.float64]) -> tuple[int, int]:
    """Return a pixel in OpenCV's fixed-point format."""
    x, y = np.round(point * (1 << _SUBPIXEL_BITS)).astype(int).tolist()
    return x, y
