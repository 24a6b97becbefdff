"""Panoramas of cardboard people in a plain hall, eyes that see cardboard, and a model that reads it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.tracker.frame import Frame, Odometry
from peopleboy.tracker.sensors.panorama.figure_patch import (
    ACROSS,
    BOTTOM_M,
    HALF_WIDTH_M,
    KNOWN,
    LAYERS,
    PEOPLE,
    TOP_M,
    UP,
    FigureMap,
)
from peopleboy.tracker.sensors.panorama.panorama_patches import PanoramaScene
from peopleboy.tracker.sensors.panorama.panorama_view import view_of
from peopleboy.tracker.sensors.panorama.place_model import PlaceEstimates
from tests.helpers.images.as_taken import as_taken

WIDTH, HEIGHT = 480, 120
CAMERA = PanoramaCalibration(
    width=WIDTH,
    height=HEIGHT,
    focal_px=111.9,
    axis_rad=math.radians(55),
    ring_radius_m=-0.023,
    ring_height_m=1.713,
)
VIEW = view_of(CAMERA, WIDTH, HEIGHT)
HALL = np.full((HEIGHT, WIDTH, 3), 120, np.uint8)
RED, GREEN, BLUE, WHITE = (200, 30, 30), (30, 180, 40), (20, 40, 190), (230, 230, 230)


@dataclass(frozen=True)
class Cardboard:
    """Somebody 0.44 m wide and 1.72 m high, who faces the robot."""

    distance_m: float
    bearing_rad: float
    shirt: tuple[int, int, int] = RED
    trousers: tuple[int, int, int] = (30, 30, 60)


def mask_of(person: Cardboard) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Where a person is seen (H, W), and how high above the floor each row meets it (H,)."""
    ways = CAMERA.bearing(np.arange(float(WIDTH))) - person.bearing_rad
    across = np.tan(np.clip(np.angle(np.exp(1j * ways)), -1.5, 1.5)) * person.distance_m
    down = CAMERA.depression(np.arange(float(HEIGHT)))
    height = CAMERA.ring_height_m - np.tan(down) * (person.distance_m - CAMERA.ring_radius_m)
    return (np.abs(across) < 0.22) & ((height > 0.0) & (height < 1.72))[:, None], height


def panorama(people: Sequence[Cardboard] = (), light: float = 1.0) -> NDArray[np.uint8]:
    """Draw people, the nearer over the farther."""
    image = HALL.copy()
    for one in sorted(people, key=lambda who: -who.distance_m):
        mask, height = mask_of(one)
        image[mask & (height >= 0.9)[:, None]] = one.shirt
        image[mask & (height < 0.9)[:, None]] = one.trousers
    return as_taken(np.rint(image * light).astype(np.uint8))


def scene_of(people: Sequence[Cardboard], columns: int = 0) -> PanoramaScene:
    """A scene in which nobody has been found yet, turned by so many columns."""
    image = as_taken(np.roll(panorama(people), columns, axis=1))
    shown = is_cardboard(image)
    return PanoramaScene.of(image, shown, shown, CAMERA)


def is_cardboard(image: NDArray[np.uint8]) -> NDArray[np.float32]:
    return (image != HALL).any(axis=2).astype(np.float32)


class CardboardEyes:
    """In the place of `Foreground`: whatever is not the hall is a person."""

    def __init__(self, model: object = None) -> None:
        del model
        self.novelty = np.zeros((HEIGHT, WIDTH), np.float32)
        self.background = HALL

    def update(
        self, image: NDArray[np.uint8], time_s: float, moved: Odometry | None, camera: PanoramaCalibration
    ) -> NDArray[np.float32]:
        del time_s, moved, camera
        self.novelty = is_cardboard(image)
        self.novelty[0, 0] = 0.0  # the noise of `frame_of`
        return self.novelty


class CardboardModel:
    """In the place of a taught model: reads from the patch where cardboard ends below, and its middle."""

    view = VIEW

    def look(self, patches: NDArray[np.float32], distance_m: NDArray[np.float64]) -> PlaceEstimates:
        told = [_read(one, away) for one, away in zip(patches, distance_m.tolist(), strict=True)]
        numbers = np.array(told, np.float32).reshape(-1, 5)
        return PlaceEstimates(evidence=numbers[:, 0], offset_m=numbers[:, 1:3], deviation_m=numbers[:, 3:])


_NOBODY = (-5.0, 0.0, 0.0, 1.0, 1.0)


def _read(patch: NDArray[np.float32], distance_m: float) -> tuple[float, ...]:
    layers = patch.reshape(LAYERS, UP, ACROSS).astype(float)
    people, known = layers[PEOPLE], layers[KNOWN]
    cell = (TOP_M - BOTTOM_M) / UP
    heights = TOP_M - cell * (np.arange(UP) + 0.5)
    columns = HALF_WIDTH_M * (1.0 - 2.0 * (np.arange(ACROSS) + 0.5) / ACROSS)
    trunk = heights > 0.5
    seen = known[trunk].sum(axis=0)
    share = np.where(seen > 2.0, people[trunk].sum(axis=0) / np.maximum(seen, 1e-6), 0.0)
    if share.sum() < 3.0:
        return _NOBODY
    # Where most of a body's width is people; of equally good places the one in the middle.
    worth = (np.abs(columns[:, None] - columns) < 0.22) @ share - 0.1 * np.abs(columns)
    best = np.abs(columns - columns[np.argmax(worth)]) < 0.22
    middle = float((share * best) @ columns / (share * best).sum())
    waist, body = trunk & (heights < 0.8), np.abs(columns - middle) < 0.3
    if known[np.ix_(waist, body)].mean() < 0.75:  # partly hidden, so hard to measure
        return 3.0, 0.0, middle, 0.4, 0.2
    near = np.abs(columns - middle) < 0.12
    legs_known = known[:, near].mean(axis=1)
    if not (legs_known[~trunk] > 0.7).all():  # its feet cannot be seen
        return 3.0, 0.0, middle, 0.3, 0.1
    column = np.where(legs_known > 0.5, people[:, near].mean(axis=1) / np.maximum(legs_known, 1e-6), 1.0)
    if column[heights < -0.25].mean() > 0.5:
        return _NOBODY
    foot = TOP_M - cell * float(column.sum())
    if foot > 0.6:
        return _NOBODY
    along = (distance_m - CAMERA.ring_radius_m) * foot / (CAMERA.ring_height_m - foot)
    return 6.0, along, middle, 0.08, 0.05


def frame_of(
    time_s: float, people: Sequence[Cardboard] | None, odometry: Odometry | None = None, light: float = 1.0
) -> Frame:
    """What the tracker gets; no image for None. One pixel is noise: no two images of a camera are equal."""
    images = {}
    if people is not None:
        images["panorama"] = panorama(people, light).copy()
        images["panorama"][0, 0] = round(1000.0 * time_s) % 256
    return Frame(
        images=images,
        time_s=time_s,
        calibrations={"panorama": CAMERA},
        odometry=Odometry() if odometry is None else odometry,
    )


def figures_of(people: NDArray[np.float32], covered: NDArray[np.float32] | None = None) -> FigureMap:
    """A map of people alone, all of it new."""
    return FigureMap.build(people, people, np.zeros_like(people) if covered is None else covered, CAMERA)
