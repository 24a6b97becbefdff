"""Localisation in a corridor by the colour image: vanishing point and wall-floor lines."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.behaviours.corridor.corridor_geometry import Corridor, Unknown
from peopleboy.behaviours.percept import Points

Image = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, kw_only=True)
class CorridorCamera:
    """Calibration of the colour camera, which is level.

    Attributes:
        focal_px: [px] focal length.
        position_m: [m] optical centre in the robot frame: forward, left, up from the floor.
    """

    focal_px: float
    position_m: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class ImageCorridorConfig:
    """Thresholds of line detection and agreement.

    Attributes:
        dark: mean grey level below which nothing is measured.
        shortest: [image heights] shorter lines are ignored.
        level_rad, upright_rad: [rad] lines this close to horizontal, or to vertical, are ignored.
        below: [image heights] lines within this distance of the horizon are ignored, since all meet there.
        agree: [image widths] lines that cross the horizon within this distance of the vanishing point agree.
        least: [image heights] least total length of lines for a vanishing point.
        share: least share of the lines' total length that must agree.
        widest_m: [m] greatest lateral distance of walls.
        bin_m: [m] lines on the floor within this distance of each other are merged.
        wall_least: [image heights] least length of a wall-floor line, minus that of opposite contrast.
        expected_m: [m] tolerance between measured and expected walls.
        width_m: [m] least and largest width of a corridor.
    """

    dark: float = 12.0
    shortest: float = 0.06
    level_rad: float = math.radians(8.0)
    upright_rad: float = math.radians(8.0)
    below: float = 0.03
    agree: float = 0.02
    least: float = 0.5
    share: float = 0.35
    widest_m: float = 4.0
    bin_m: float = 0.1
    wall_least: float = 0.2
    expected_m: float = 0.5
    width_m: tuple[float, float] = (1.1, 7.0)


def corridor_from_image(
    colour: Image | None,
    camera: CorridorCamera,
    expected: Corridor | None = None,
    config: ImageCorridorConfig | None = None,
) -> Corridor | Unknown:
    """Return the corridor from the lines of one image.

    Lines along the corridor meet at the vanishing point; for a level camera it is on the middle row, and its
    column gives the heading. A line on the floor at distance d to the left starts there with a slope of -d /
    (h cos heading) columns per row, where h is the camera's height.

    Args:
        colour: (H, W, 3) sRGB; None without an image.
        camera: calibration of the camera.
        expected: the corridor predicted by dead reckoning; None if unknown.
        config: thresholds.
    """
    config = ImageCorridorConfig() if config is None else config
    if colour is None:
        return Unknown("no image")
    grey = np.asarray(cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY), dtype=np.uint8)
    if float(grey.mean()) < config.dark:
        return Unknown("too dark")
    height, width = grey.shape
    by_paint = _lines(_paint(colour), config)
    by_light = _lines(grey, config)
    lines = np.concatenate([by_light, by_paint])
    vanishing = _vanishing_column(lines, height, width, config)
    if isinstance(vanishing, Unknown):
        return vanishing
    heading = math.atan((vanishing - (width - 1) / 2.0) / camera.focal_px)
    is_meeting = np.abs(_crossing(lines, (height - 1) / 2.0) - vanishing) < config.agree * width
    is_light = np.arange(len(lines)) < len(by_light)
    floor = [
        _floor_lines(lines[is_meeting & kind], height, heading, camera, config)
        for kind in (is_light, ~is_light)
    ]
    left, right = (_wall(floor, side, height, config) for side in (1, -1))
    return _corridor(heading, left, right, camera, expected, config)


def _paint(colour: Image) -> Image:
    """Return the ratio of red to blue as a grey image; light, shadow and floor tiles change it little."""
    red, green, blue = np.moveaxis(colour.astype(np.float32), 2, 0)
    share = (red - blue) / (red + green + blue + 10.0)
    paint: Image = np.clip(64.0 + 1000.0 * share, 0.0, 255.0).astype(np.uint8)
    return paint


def _lines(grey: Image, config: ImageCorridorConfig) -> Points:
    """Return straight lines that are neither horizontal nor vertical: (N, 4) [px] u, v of both ends.

    Source: von Gioi, Jakubowicz, Morel and Randall, LSD: a line segment detector (2012), in OpenCV. The
    brighter side is always on the same side of the direction from the first end to the second.
    """
    found = cv2.createLineSegmentDetector(cv2.LSD_REFINE_NONE).detect(grey)[0]
    # OpenCV returns None without lines, contrary to its type stubs.
    lines = np.array([] if found is None else found, dtype=np.float64).reshape(-1, 4)
    du, dv = np.abs(lines[:, 2] - lines[:, 0]), np.abs(lines[:, 3] - lines[:, 1])
    slope = np.arctan2(dv, du)
    is_long = np.hypot(du, dv) > config.shortest * len(grey)
    is_slanting = (slope > config.level_rad) & (slope < math.pi / 2.0 - config.upright_rad)
    kept: Points = lines[is_long & is_slanting]
    return kept


def _crossing(lines: Points, row: float) -> Points:
    """Return the column [px] at which each line, extended, crosses a row [px]: (N,)."""
    u0, v0, u1, v1 = lines.T
    columns: Points = u0 + (row - v0) * (u1 - u0) / (v1 - v0)
    return columns


def _length(lines: Points) -> Points:
    lengths: Points = np.hypot(lines[:, 2] - lines[:, 0], lines[:, 3] - lines[:, 1])
    return lengths


def _vanishing_column(lines: Points, height: int, width: int, config: ImageCorridorConfig) -> float | Unknown:
    """Return the column [px] of the horizon that most lines cross, by length."""
    columns, lengths = _crossing(lines, (height - 1) / 2.0), _length(lines)
    if lengths.sum() < config.least * height:
        return Unknown("too few lines")
    is_near = np.abs(columns[:, None] - columns) < config.agree * width
    votes = is_near @ lengths
    best = int(np.argmax(votes))
    if votes[best] < max(config.least * height, config.share * lengths.sum()):
        return Unknown("the lines do not meet")
    column = float(np.average(columns[is_near[best]], weights=lengths[is_near[best]]))
    return column if 0.0 <= column < width else Unknown("the lines meet outside the image")


def _floor_lines(
    lines: Points, height: int, heading: float, camera: CorridorCamera, config: ImageCorridorConfig
) -> Points:
    """Project lines below the horizon to the floor: (M, 2) [m] to the left of the camera, [px] length.

    A length is negative for the opposite contrast.
    """
    horizon = (height - 1) / 2.0
    low = lines[np.minimum(lines[:, 1], lines[:, 3]) > horizon + config.below * height]
    du, dv = low[:, 2] - low[:, 0], low[:, 3] - low[:, 1]
    left_m = -du / dv * camera.position_m[2] * math.cos(heading)
    floor: Points = np.stack([left_m, np.sign(dv) * np.hypot(du, dv)], axis=1)
    return floor[np.abs(left_m) < config.widest_m]


def _wall(floor: Sequence[Points], side: int, height: int, config: ImageCorridorConfig) -> float | None:
    """Return the distance [m] of the wall-floor line of one side from the camera, or None.

    Floor tiles alternate along their edges, so their contributions cancel. The line at the foot of a wall has
    the same sign everywhere, in brightness and in colour.
    """
    away = side * np.concatenate([lines[:, 0] for lines in floor])
    tried = away[away > 0.0]
    if not len(tried):
        return None
    support = sum(
        np.abs((np.abs(tried[:, None] - side * lines[:, 0]) < config.bin_m) @ lines[:, 1]) for lines in floor
    )
    best = int(np.argmax(support))
    if np.max(support) < config.wall_least * height:
        return None
    lengths = np.abs(np.concatenate([lines[:, 1] for lines in floor]))
    is_near = np.abs(away - tried[best]) < config.bin_m
    return float(np.average(away[is_near], weights=lengths[is_near]))


def _corridor(
    heading: float,
    left: float | None,
    right: float | None,
    camera: CorridorCamera,
    expected: Corridor | None,
    config: ImageCorridorConfig,
) -> Corridor | Unknown:
    """Return the robot's pose between the walls; an undetected wall is placed by the known width."""
    if expected is not None and left is None and right is not None:
        left = expected.width_m - right
    if expected is not None and right is None and left is not None:
        right = expected.width_m - left
    if left is None or right is None:
        return Unknown("no line between wall and floor")
    if not config.width_m[0] <= left + right <= config.width_m[1]:
        return Unknown(f"walls {left + right:.1f} m apart are not a corridor")
    ahead_m, aside_m, _ = camera.position_m
    offset = (right - left) / 2.0 - ahead_m * math.sin(heading) - aside_m * math.cos(heading)
    seen = Corridor(offset_m=offset, heading_rad=heading, width_m=left + right)
    if expected is not None and _is_far_off(seen, expected, config):
        return Unknown("the lines do not match the predicted pose")
    return seen


def _is_far_off(seen: Corridor, expected: Corridor, config: ImageCorridorConfig) -> bool:
    return (
        abs(seen.offset_m - expected.offset_m) > config.expected_m
        or abs(seen.width_m - expected.width_m) > config.expected_m
    )
