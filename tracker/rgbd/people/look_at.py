"""Looking at places on the floor: what colours a body there would have, and how far away it is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.rgbd.detection.depth_view import Depth, DepthView
from peopleboy.tracker.rgbd.people.looks import BINS, bin_at, bin_of_colour
from peopleboy.tracker.track import Box

Image = NDArray[np.uint8]

COLUMNS: Final = 10
ROWS: Final = 20
_MIDDLE: Final = np.array([3, 7, 5, 15])  # columns from, to, rows from, to, whose depth is measured
_LEAST_SAMPLES: Final = 20
_NOWHERE_M: Final = 10.0


@dataclass(frozen=True, slots=True, eq=False)
class RgbdView:
    """One frame of the sensor.

    Attributes:
        depth: (H, W) [mm].
        colour: (H, W, 3) RGB of the same pixels.
        geometry: how pixels map to metres.
        body_m: [m] from the surface that the camera sees to the middle of a body.
    """

    depth: Depth
    colour: Image
    geometry: DepthView
    body_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """What a person measures and looks like.

    Attributes:
        width_m: [m].
        head_m, low_m: [m] above the floor, of the top and of the lowest part seen.
        looks: (BINS,) histogram.
    """

    width_m: float
    head_m: float
    low_m: float
    looks: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Glance:
    """What is at P places.

    Attributes:
        similarity: (P,) of the colours there to a body's, 0..1.
        miss_m: (P,) [m] from the place to where the middle of its box is measured.
        nearer, beyond: (P,) share of readings that are more than half a metre before and behind it.
    """

    similarity: Floats
    miss_m: Floats
    nearer: Floats
    beyond: Floats


def look_at(view: RgbdView, places_m: Floats, body: Body, foreground_m: float) -> Glance:
    """Look at places (P, 2) in the robot's frame."""
    pose = view.geometry.calibration.robot_from_camera
    told = _glances(
        view.depth,
        view.colour,
        np.ascontiguousarray(pose[:3, :3]),
        np.ascontiguousarray(pose[:3, 3]),
        np.array([view.geometry.focal_px, view.geometry.centre_u, view.geometry.centre_v]),
        np.ascontiguousarray(places_m),
        np.array([body.width_m, body.head_m, body.low_m, view.body_m]),
        body.looks,
        foreground_m if foreground_m > 0.0 else math.inf,
        bin_of_colour(),
    )
    return Glance(told[:, 0], told[:, 1], told[:, 2], told[:, 3])


def box_at(geometry: DepthView, place_m: Floats, body: Body) -> Box:
    """Give the box [px] of a body at a place (2,), which may reach outside the image."""
    pose = geometry.calibration.robot_from_camera
    intrinsics = np.array([geometry.focal_px, geometry.centre_u, geometry.centre_v])
    left, top, width, height, _ = _box(
        pose[:3, :3], pose[:3, 3], intrinsics, place_m, body.width_m, body.head_m, body.low_m
    )
    return left, top, width, height


def looks_in(view: RgbdView, box: Box) -> Floats:
    """Give the histogram (BINS,) of what stands out in a box (SA eq. 4.24).

    Its readings are parted into two by their depths; the nearer ones are taken.
    """
    return np.asarray(_foreground_looks(view.depth, view.colour, np.array(box), bin_of_colour()))


@njit(cache=True, nogil=True)
def _box(
    rotation: Floats,
    origin: Floats,
    camera: Floats,
    place: Floats,
    width_m: float,
    head_m: float,
    low_m: float,
) -> tuple[float, float, float, float, float]:
    """Give left, top, width, height [px] and depth [m] of a body; depth 0 for behind the camera."""
    ends = np.empty((2, 3))
    for k in range(2):
        dx, dy, dz = place[0] - origin[0], place[1] - origin[1], (head_m if k == 0 else low_m) - origin[2]
        for axis in range(3):
            ends[k, axis] = rotation[0, axis] * dx + rotation[1, axis] * dy + rotation[2, axis] * dz
    depth = 0.5 * (ends[0, 2] + ends[1, 2])
    if min(ends[0, 2], ends[1, 2]) < 0.2:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    focal = camera[0]
    width = focal * width_m / depth
    middle = camera[1] + focal * 0.5 * (ends[0, 0] / ends[0, 2] + ends[1, 0] / ends[1, 2])
    top = camera[2] + focal * ends[0, 1] / ends[0, 2]
    bottom = camera[2] + focal * ends[1, 1] / ends[1, 2]
    return middle - width / 2.0, top, width, bottom - top, depth


@njit(cache=True, nogil=True)
def _glances(
    depth: Depth,
    colour: Image,
    rotation: Floats,
    origin: Floats,
    camera: Floats,
    places: Floats,
    body: Floats,
    looks: Floats,
    foreground_m: float,
    table: NDArray[np.uint8],
) -> Floats:
    """Give similarity, miss, share nearer, share beyond (P, 4)."""
    found = np.zeros((len(places), 4))
    found[:, 1] = _NOWHERE_M
    for n in range(len(places)):
        left, top, width, height, z = _box(rotation, origin, camera, places[n], body[0], body[1], body[2])
        if z <= 0.0:
            continue
        counts = np.zeros(BINS)
        samples = readings = nearer = beyond = middle = 0
        x_sum = z_sum = 0.0
        for row in range(ROWS):
            v = int(top + (row + 0.5) / ROWS * height + 0.5)
            if v < 0 or v >= depth.shape[0]:
                continue
            for column in range(COLUMNS):
                u = int(left + (column + 0.5) / COLUMNS * width + 0.5)
                if u < 0 or u >= depth.shape[1]:
                    continue
                reading = depth[v, u] / 1000.0
                off = reading + body[3] - z
                if reading > 0.0:
                    readings += 1
                    nearer += off < -0.5
                    beyond += off > 0.5
                    if _MIDDLE[0] <= column < _MIDDLE[1] and _MIDDLE[2] <= row < _MIDDLE[3]:
                        middle += 1
                        z_sum += reading + body[3]
                        x_sum += (u - camera[1]) / camera[0] * reading
                if math.isinf(foreground_m) or (reading > 0.0 and abs(off) < foreground_m):
                    samples += 1
                    counts[bin_at(colour, v, u, table)] += 1.0
        if readings > 0:
            found[n, 2], found[n, 3] = nearer / readings, beyond / readings
        if samples < _LEAST_SAMPLES or middle == 0:
            continue
        similar = 0.0
        for k in range(BINS):
            similar += math.sqrt(looks[k] * counts[k] / samples)
        found[n, 0] = similar
        found[n, 1] = _miss(rotation, origin, places[n], x_sum / middle, z_sum / middle)
    return found


@njit(cache=True, nogil=True)
def _miss(rotation: Floats, origin: Floats, place: Floats, x: float, z: float) -> float:
    """Give the distance [m] on the floor of a place from a point of the optical frame."""
    across = rotation[0, 0] * x + rotation[0, 2] * z + origin[0] - place[0]
    aside = rotation[1, 0] * x + rotation[1, 2] * z + origin[1] - place[1]
    return math.hypot(across, aside)


@njit(cache=True, nogil=True)
def _foreground_looks(depth: Depth, colour: Image, box: Floats, table: NDArray[np.uint8]) -> Floats:
    readings = np.zeros(4 * ROWS * COLUMNS)
    bins = np.zeros(4 * ROWS * COLUMNS, np.int64)
    n = 0
    for row in range(2 * ROWS):
        v = int(box[1] + (row + 0.5) / (2 * ROWS) * box[3])
        for column in range(2 * COLUMNS):
            u = int(box[0] + (column + 0.5) / (2 * COLUMNS) * box[2])
            if 0 <= v < depth.shape[0] and 0 <= u < depth.shape[1] and depth[v, u] > 0:
                readings[n] = depth[v, u] / 1000.0
                bins[n] = bin_at(colour, v, u, table)
                n += 1
    counts = np.zeros(BINS)
    if n == 0:
        return counts
    limit = _between_two(readings[:n])
    for k in range(n):
        if readings[k] <= limit:
            counts[bins[k]] += 1.0
    return counts / counts.sum()


@njit(cache=True, nogil=True)
def _between_two(readings: Floats) -> float:
    """Part readings [m] into two by their means; give the limit between them (SA 4.4.2)."""
    near, far = readings.min(), readings.max()
    for _ in range(10):
        limit = 0.5 * (near + far)
        is_near = readings <= limit
        if is_near.all():
            break
        near, far = readings[is_near].mean(), readings[~is_near].mean()
    return 0.5 * (near + far)
