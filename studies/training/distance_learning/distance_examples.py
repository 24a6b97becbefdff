"""Examples of people in the panorama: what is measured of them, and where they truly were."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.sim.config import WorldConfig
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.tracker.frame import PANORAMA, Frame
from peopleboy.tracker.panoramic.panorama_view import PanoramaView, view_of
from peopleboy.tracker.panoramic.paper.depth_cues import (
    EMPTY_IMAGES,
    MeasuredFigure,
    learn_background,
    measure,
)
from peopleboy.tracker.panoramic.paper.paper_tracker import PanoramicConfig

Floats = NDArray[np.float64]
Row = list[float]
"""An example as plain data: person, time [s], three cues [px], bearing seen [rad], x and y in truth [m]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Examples:
    """The examples of one run, in the order of time.

    Attributes:
        person: (N,) number of who it is.
        time_s: (N,) of the image [s].
        cues: (N, 3) as `DepthCues` has them [px].
        bearing_rad: (N,) where the silhouette is, left positive [rad].
        true_m: (N, 2) where the person stands in the robot's frame [m]; the middle between the feet, not the
            hat of the paper.
    """

    person: NDArray[np.int64]
    time_s: Floats
    cues: Floats
    bearing_rad: Floats
    true_m: Floats

    @property
    def distance_m(self) -> Floats:
        """True distances (N,) from the robot's middle [m]."""
        return np.asarray(np.hypot(*self.true_m.T), np.float64)

    @property
    def angle_error_rad(self) -> Floats:
        """What the silhouette's bearing is off by, (N,) in 0..pi [rad]."""
        off = self.bearing_rad - np.arctan2(self.true_m[:, 1], self.true_m[:, 0])
        return np.asarray(np.abs(np.angle(np.exp(1j * off))), np.float64)

    def seen_at(self, distance_m: Floats) -> Floats:
        """Place people on the floor, (N, 2) in the robot's frame, at distances (N,) told by somebody [m]."""
        way = np.stack([np.cos(self.bearing_rad), np.sin(self.bearing_rad)], axis=1)
        return np.asarray(distance_m[:, None] * way, np.float64)

    @classmethod
    def of_rows(cls, rows: list[Row]) -> Examples:
        """Make examples out of plain data, equal to the last digit."""
        table = np.array(rows, np.float64).reshape(-1, 8)
        return cls(
            person=table[:, 0].astype(np.int64),
            time_s=table[:, 1],
            cues=table[:, 2:5],
            bearing_rad=table[:, 5],
            true_m=table[:, 6:],
        )


def collect(scenario: str, seed: int) -> dict[str, Any]:
    """Watch a scenario with the panoramic camera, and keep what is measured while one person is there.

    Returns:
        Plain data: the camera's `view`, `rows` of examples, and how many images `missed` the person.

    Raises:
        BadInput: an unknown scenario, somebody in the first images, or a camera that nobody can calibrate or
            that sees no floor where people walk.
    """
    loaded = load_scenario(scenario).mounting((PANORAMA,))
    config = loaded.world(seed)
    view = see_floor(config, scenario)
    rows, missed = _measured(panoramas(config, loaded.duration_s), scenario)
    return {"view": asdict(view), "rows": rows, "missed": missed}


def see_floor(config: WorldConfig, scenario: str) -> PanoramaView:
    """Describe the panoramic camera, before it has seen anything.

    Raises:
        BadInput: it cannot be calibrated, or nobody ever walks where it sees the floor.
    """
    camera, calibrations = config.robot.cameras[PANORAMA], calibrations_of(config.robot.cameras)
    if PANORAMA not in calibrations:
        raise BadInput(f"{scenario}: camera {PANORAMA!r} of kind {camera.kind!r} cannot be calibrated")
    ways = [point.at_m for person in config.people for point in person.path]
    if not ways:
        raise BadInput(f"{scenario}: nobody walks there")
    away = np.subtract(ways, config.robot.at_m)
    farthest = np.array([[float(np.hypot(*away.T).max()), 0.0, 0.0]])
    row = float(calibrations[PANORAMA].project(farthest)[0, 1])
    if not row < camera.camera.height:  # as below: steeper than any row looks; NaN: no lens sees it
        raise BadInput(
            f"{scenario}: camera {PANORAMA!r} sees no floor where people walk; take another mirror"
        )
    return view_of(calibrations[PANORAMA], camera.camera.width, camera.camera.height)


def panoramas(config: WorldConfig, duration_s: float) -> Iterator[tuple[NDArray[np.uint8], ImageFreeTruth]]:
    """Yield every image (H, W, 3) of the panoramic camera, and who was there; no other images are made."""
    from peopleboy.sim.world import World  # here, as examples that are there can be read without PyBullet

    with World(config) as world:
        for _ in range(round(duration_s * config.control_hz)):
            observation = world.observe()
            if PANORAMA in observation.images:
                frame = Frame(images=observation.images, time_s=observation.time_s)
                yield frame.rgb(PANORAMA), world.scene()
            world.step(0.0, 0.0)


def _measured(
    instants: Iterator[tuple[NDArray[np.uint8], ImageFreeTruth]], scenario: str
) -> tuple[list[Row], int]:
    """Measure the one person of each image after the empty ones, and count the images that show nobody."""
    first = list(islice(instants, EMPTY_IMAGES))
    if len(first) < EMPTY_IMAGES or any(scene.people for _, scene in first):
        raise BadInput(
            f"{scenario}: the first {EMPTY_IMAGES} panoramas must be empty: they are the background"
        )
    background = learn_background([image for image, _ in first])
    rows, missed = [], 0
    for image, scene in instants:
        figure = measure(background.silhouette(image), PanoramicConfig().least_px)
        if len(scene.people) == 1 and figure is not None:
            rows.append(_row(figure, scene))
        missed += bool(scene.people) and figure is None
    return rows, missed


def _row(figure: MeasuredFigure, scene: ImageFreeTruth) -> Row:
    (person,) = scene.people
    place = scene.robot.to_local(person.position_m)
    return [float(person.id), scene.time_s, *figure.cues, figure.bearing_rad, *place]
