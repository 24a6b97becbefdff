"""The corridor as the colour camera sees it: vanishing point and the lines between walls and floor."""

from __future__ import annotations

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
    """What must be known of the colour camera, which sits level.

    Attributes:
        focal_px: [px] focal length.
        position_m: [m] optical centre in the robot's frame: forward, left, up from the floor.
    """

    focal_px: float
    position_m: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class ImageCorridorConfig:
    """What counts as a line, and how many must agree.

    Attributes:
        dark: mean grey level below which nothing is measured.
        shortest: [image heights] lines that are shorter do not count.
        level_rad, upright_rad: [rad] lines this close to level, or to upright, do not count.
        below: [image heights] lines within this of the horizon do not count: there all meet.
        agree: [image widths] lines that cross the horizon within this of the vanishing point agree.
        least: [image heights] summed length of lines that make a vanishing point.
        share: of all lines' length, the least that must agree.
        widest_m: [m] walls farther to the side than this are not looked for.
        bin_m: [m] lines on the floor within this of each other are one.
        wall_least: [image heights] length of a wall-floor line, less what runs against it.
        expected_m: [m] walls farther than this off the expected ones do not agree with them.
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
    """Find the centre line and heading from the lines of one image.

    Lines along the corridor meet at the vanishing point; a level camera has it on the middle row, and its
    column gives the heading. A line on the floor at d to the left runs from there by -d / (h cos heading)
    columns a row, h being the camera's height.

    Args:
        colour: (H, W, 3) sRGB; None where there is no image.
        camera: the camera that took it.
        expected: the place by dead reckoning; None where nothing is known.
        config: what counts.
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
    """Give the share of red over blue as a grey image; light, shade and a floor's tiles change it little."""
    red, green, blue = np.moveaxis(colour.astype(np.float32), 2, 0)
    share = (red - blue) / (red + green + blue + 10.0)
    paint: Image = np.clip(64.0 + 1000.0 * share, 0.0, 255.0).astype(np.uint8)
    return paint


def _lines(grey: Image, config: ImageCorridorConfig) -> Points:
    """Find straight lines that are neither level nor upright: (N, 4) [px] u, v of both ends.

    Source: von Gioi, Jakubowicz, Morel and Randall, LSD: a line segment detector (2012), in OpenCV. The
    brighter side is always on the same hand of the way from the first end to the second.
    """
    found = cv2.createLineSegmentDetector(cv2.LSD_REFINE_NONE).detect(grey)[0]
    # OpenCV says None where it finds none, whatever its types promise.
    lines = np.array([] if found is None else found, dtype=np.float64).reshape(-1, 4)
    du, dv = np.abs(lines[:, 2] - lines[:, 0]), np.abs(lines[:, 3] - lines[:, 1])
    slope = np.arctan2(dv, du)
    is_long = np.hypot(du, dv) > config.shortest * len(grey)
    is_slanting = (slope > config.level_rad) & (slope < math.pi / 2.0 - config.upright_rad)
    kept: Points = lines[is_long & is_slanting]
    return kept


def _crossing(lines: Points, row: float) -> Points:
    """Return the column [px] at which each line, drawn on, crosses a row [px]: (N,)."""
    u0, v0, u1, v1 = lines.T
    columns: Points = u0 + (row - v0) * (u1 - u0) / (v1 - v0)
    return columns


def _length(lines: Points) -> Points:
    lengths: Points = np.hypot(lines[:, 2] - lines[:, 0], lines[:, 3] - lines[:, 1])
    return lengths


def _vanishing_column(lines: Points, height: int, width: int, config: ImageCorridorConfig) -> float | Unknown:
    """Find the column [px] of the horizon through which most lines go, by length."""
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
    """Take lines below the horizon for lines on the floor: (M, 2) [m] to the left of the camera, [px] length.

    A length is negative where the line's darker side is the other one.
    """
    horizon = (height - 1) / 2.0
    low = lines[np.minimum(lines[:, 1], lines[:, 3]) > horizon + config.below * height]
    du, dv = low[:, 2] - low[:, 0], low[:, 3] - low[:, 1]
    left_m = -du / dv * camera.position_m[2] * math.cos(heading)
    floor: Points = np.stack([left_m, np.sign(dv) * np.hypot(du, dv)], axis=1)
    return floor[np.abs(left_m) < config.widest_m]


def _wall(floor: Sequence[Points], side: int, height: int, config: ImageCorridorConfig) -> float | None:
    """Find the wall-floor line of one side: its distance [m] from the camera, None if there is none.

    The tiles of a floor change from dark to bright and back along their edge, so that its pieces cancel; the
    line at a wall's foot has the same sign all along, in light and in paint.
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
    """Put the robot between the walls; one that is not seen stands where the known width says."""
    if expected is not None and left is None and right is not None:
        left = expected.width_m - right
    if expected is not None and right is None and left is not None:
        right = expected.width_m - left
    if left is None or right is None:
        return Unknown("no line between wall and floor")
    if not config.width_m[0] <= left + right <= config.width_m[1]:
        return Unknown(f"walls {left + right:.1f} m apart make no corridor")
    ahead_m, aside_m, _ = camera.position_m
    offset = (right - left) / 2.0 - ahead_m * math.sin(heading) - aside_m * math.cos(heading)
    seen = Corridor(offset_m=offset, heading_rad=heading, width_m=left + right)
    if expected is not None and _is_far_off(seen, expected, config):
        return Unknown("the lines do not fit where the robot was")
    return seen


def _is_far_off(seen: Corridor, expected: Corridor, config: ImageCorridorConfig) -> bool:
    return (
        abs(seen.offset_m - expected.offset_m) > config.expected_m
        or abs(seen.width_m - expected.width_m) > config.expected_m
    )
