"""What the depth image and its colours show at the expected position of a person."""

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, THERMAL, Floats, Frame
from peopleboy.tracker.sensors.depth.depth_view import Depth, DepthView, box_at
from peopleboy.tracker.sensors.depth.pre_detection import PreDetection
from peopleboy.tracker.track import Box
from peopleboy.tracker.tracking.appearance import FEATURES, Colours, describe_samples

# Share of an object's surface that is as warm as people: depth gives the pixels in the thermal image.

WARM: Final = 255.0 * (25.0 - 24.0) / (36.0 - 24.0)
"""Grey from which a surface counts as warm: 25 degC in an image of 24 to 36 degC."""

_WARM_COLUMNS: Final = 10
_WARM_ROWS: Final = 20
_REACH_M: Final = 0.5  # from the measured depth, within which pixels belong to the object
_LEAST_PIXELS: Final = 12


def warmth(found: PreDetection, frame: Frame) -> float | None:
    """Return the share of a detection's pixels that are warm; None where the thermal image lacks them."""
    pixels = grid(found.box, _WARM_COLUMNS, _WARM_ROWS, frame)
    z_m = depths_at(pixels, frame)
    own = (z_m > 0.0) & (np.abs(z_m - found.z_m) < _REACH_M)
    return warm_share(pixels[own], z_m[own], frame)


def warm_share(pixels: NDArray[np.int64], z_m: Floats, frame: Frame) -> float | None:
    """Return the share of surface pixels that are as warm as people.

    Args:
        pixels: (N, 2) pixels of the depth image.
        z_m: (N,) their depths [m].
        frame: with a thermal and a depth image.

    Returns:
        0..1; None if too few of the pixels are in the thermal image.
    """
    ours, theirs = frame.calibrations.get(DEPTH), frame.calibrations.get(THERMAL)
    if not isinstance(ours, PinholeCalibration) or theirs is None or THERMAL not in frame.images:
        return None
    points = ours.robot_from_camera[:3, 3] + ours.rays(pixels.astype(np.float64)) * z_m[:, None]
    seen, image = np.rint(theirs.project(points)), frame.grey(THERMAL)
    inside = (seen >= 0.0).all(axis=1) & (seen < np.array(image.shape[::-1])).all(axis=1)
    if inside.sum() < _LEAST_PIXELS:
        return None
    columns, rows = seen[inside].astype(np.int64).T
    return float((image[rows, columns] > WARM).mean())


def grid(box: Box, columns: int, rows: int, frame: Frame) -> NDArray[np.int64]:
    """Return pixels (N, 2) spread evenly over the part of a box [px] inside the depth image."""
    left, top, width, height = box
    u = left + width * (np.arange(columns) + 0.5) / columns
    v = top + height * (np.arange(rows) + 0.5) / rows
    pixels = np.rint(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)).astype(np.int64)
    size = np.array(frame.depth(DEPTH).shape[::-1])
    return np.asarray(pixels[((pixels >= 0) & (pixels < size)).all(axis=1)])


def depths_at(pixels: NDArray[np.int64], frame: Frame) -> Floats:
    """Return the depths (N,) [m] at pixels (N, 2) of the depth image; 0 for no reading."""
    return np.asarray(frame.depth(DEPTH)[pixels[:, 1], pixels[:, 0]] / 1000.0)


BODY_M: Final = 0.1  # from the visible surface to the middle of a body
REACH_M: Final = 0.4  # from that surface, within which readings belong to the person

_COLUMNS: Final = 8
_ROWS: Final = 16
_LEAST: Final = 12  # readings needed for meaningful shares


@dataclass(frozen=True, slots=True)
class DepthVisibility:
    """Depth readings at the expected position of a person.

    Attributes:
        nearer, beyond: shares of the readings in front of and behind the person.
        warm: share of the person's own readings that are warm; None if too few are in the thermal image.
    """

    nearer: float
    beyond: float
    warm: float | None


def depth_visibility(
    place_m: Floats, wide_m: float, tall_m: float, frame: Frame, reach_m: float = REACH_M
) -> DepthVisibility | None:
    """Read the depth image around the middle of a person at a position (2,) in the robot frame.

    Args:
        place_m: forward, left [m].
        wide_m: width of the person.
        tall_m: height of the person.
        frame: with or without a depth image.
        reach_m: [m] by which the person may be nearer or farther.

    Returns:
        None without a depth image, or if the position is outside it.
    """
    view = view_of(frame)
    if view is None:
        return None
    left, top, width, height = box_at(view, place_m, wide_m, tall_m)
    if width <= 0.0:
        return None
    middle = (left + 0.2 * width, top + 0.05 * height, 0.6 * width, 0.8 * height)
    pixels = grid(middle, _COLUMNS, _ROWS, frame)
    z_m = depths_at(pixels, frame)
    pixels, z_m = pixels[z_m > 0.0], z_m[z_m > 0.0]
    if len(z_m) < _LEAST:
        return None
    off = z_m - surface_m(view, place_m)
    own = np.abs(off) < reach_m
    return DepthVisibility(
        nearer=float((off <= -reach_m).mean()),
        beyond=float((off >= reach_m).mean()),
        warm=warm_share(pixels[own], z_m[own], frame),
    )


def view_of(frame: Frame) -> DepthView | None:
    """Return the geometry of a frame's depth image; None without one."""
    if DEPTH not in frame.images or DEPTH not in frame.calibrations:
        return None
    return DepthView.of(frame.calibrations[DEPTH], DEPTH)


def shoulders(view: DepthView, place_m: Floats, wide_m: float, low_m: float, high_m: float) -> Floats:
    """Return left, top, width, height [px] of a body between two heights above the floor."""
    return np.array(box_at(view, place_m, wide_m, high_m, low_m))


def surface_m(view: DepthView, place_m: Floats) -> float:
    """Return the depth [m] of the visible surface of a person at a position (2,)."""
    pose = view.calibration.robot_from_camera
    point = np.array([*place_m, pose[2, 3]])
    return float((point - pose[:3, 3]) @ pose[:3, 2]) - BODY_M


_SAMPLED_ROWS: Final = 32
_SAMPLED_COLUMNS: Final = 11
_SAMPLED_M: Final = 0.4  # width in which colours are sampled
_OWN_M: Final = 0.3  # from a person's surface, within which readings are the person's


def describe_readings(frame: Frame, place_m: Floats, tall_m: float) -> Colours:
    """Return the colours (FEATURES,) of a person at a position (2,), from the person's own readings.

    Readings in front of or behind the person, and next to edges, are left out, so that occluders and
    background do not count.
    """
    view = view_of(frame)
    if view is None:
        return np.zeros(FEATURES, np.float32)
    left, top, width, height = shoulders(view, place_m, _SAMPLED_M, 0.0, tall_m)
    depth, image = frame.depth(DEPTH), frame.rgb(DEPTH_COLOUR)
    if width <= 0.0:
        return np.zeros(FEATURES, np.float32)
    across = (np.arange(_SAMPLED_COLUMNS) + 0.5) / _SAMPLED_COLUMNS
    down = (np.arange(_SAMPLED_ROWS) + 0.5) / _SAMPLED_ROWS
    u = np.rint(left + width * across).astype(np.int64)
    v = np.rint(top + height * down).astype(np.int64)
    is_inside = (v >= 0) & (v < depth.shape[0])
    v, down = v[is_inside], down[is_inside]
    u = u[(u >= 0) & (u < depth.shape[1])]
    own = np.abs(depth[np.ix_(v, u)] / 1000.0 - surface_m(view, place_m)) < _OWN_M
    inner = own.copy()
    inner[:, 1:] &= own[:, :-1]
    inner[:, :-1] &= own[:, 1:]
    rows, columns = np.nonzero(inner)
    return describe_samples(image[v[rows], u[columns]], down[rows])


# The torso of a person in the depth image, which arms and legs do not move.

_TORSO_ROWS: Final = np.linspace(0.18, 0.5, 12)  # rows of the torso, in heights from the head down
_BESIDE: Final = 0.1  # in heights, searched to either side of an object
_TORSO_M: Final = 0.35  # from an object's depth, within which readings belong to it
_SIDE_PX: Final = 3  # columns beside a torso in which something nearer hides its side
_NARROWEST: Final = 0.12  # least width of a torso, in heights
_MOST: Final = 0.5  # share of a column's readings that decides what it shows


class Torso(NamedTuple):
    """The torso of a person in the depth image: its middle column, and its width."""

    middle_px: float
    width_px: float


def find_torso(found: PreDetection, height_px: float, depth: Depth) -> Torso | None:
    """Find the torso of an object of a whole height [px] in a depth image.

    None if the object reaches the border of the image, if something nearer hides a side of it, or if it is
    narrower than a torso.
    """
    left, top, width, _ = found.box
    first, last = int(left - _BESIDE * height_px), int(left + width + _BESIDE * height_px)
    rows = np.rint(top + _TORSO_ROWS * height_px).astype(np.int64)
    rows = rows[(rows >= 0) & (rows < len(depth))]
    if first < 0 or last >= depth.shape[1] or len(rows) < len(_TORSO_ROWS) // 2:
        return None
    z_m = depth[rows, first : last + 1] / 1000.0
    own = np.flatnonzero((np.abs(z_m - found.z_m) < _TORSO_M).mean(axis=0) > _MOST)
    if not len(own):
        return None
    is_nearer = ((z_m > 0.0) & (z_m <= found.z_m - _TORSO_M)).mean(axis=0) > _MOST
    sides = is_nearer[max(own[0] - _SIDE_PX, 0) : own[-1] + 1 + _SIDE_PX]
    if sides.any() or len(own) < _NARROWEST * height_px:
        return None
    return Torso(first + float(own.mean()), float(len(own)))
