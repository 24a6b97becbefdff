"""Playing a drive for trackers that see depth: frames, and where people truly are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.schema.robot import RobotSpec
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.loop.loop import make_frame
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.observation import Observation
from peopleboy.sim.truth.truth import PersonTruth, Truth
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame
from peopleboy.tracker.rgbd.depth_view import DepthView
from peopleboy.tracker.track import Box

FARTHEST_M = 10.0
LEAST_PX = 200  # of somebody who counts; fewer are a hand or a foot


@dataclass(frozen=True, slots=True, kw_only=True)
class Stander:
    """Where somebody is at one instant.

    Attributes:
        id: of the person.
        place_m: forward, left of the robot [m], of the body's middle.
        surface_m: the same of the surface that the camera sees in the middle of the person; None for none.
        distance_m: on the floor, from the camera.
        inside: share of the whole body that is inside the image.
        hidden: share of that which others hide.
        is_counted: whether a tracker has to find the person.
        box: of the visible pixels, and of the whole body; None for none.
        whole_box: likewise.
    """

    id: int
    place_m: tuple[float, float]
    surface_m: tuple[float, float] | None
    distance_m: float
    inside: float
    hidden: float
    is_counted: bool
    box: Box | None
    whole_box: Box | None


@dataclass(frozen=True, slots=True, eq=False)
class DriveMoment:
    """One instant of a drive.

    Attributes:
        number: of the frame, from 1.
        frame: what a tracker is given.
        people: everybody who is there.
        robot: its true pose.
        observation: all that the robot sensed.
    """

    number: int
    frame: Frame
    people: tuple[Stander, ...]
    robot: Planar
    observation: Observation


def play_drive(scenario: Scenario, seed: int) -> Iterator[DriveMoment]:
    """Play a scenario, and yield every image of the depth camera, which is mounted if there is none.

    Raises:
        BadInput: the robot needs eyes to drive.
    """
    scenario = scenario.mounting((DEPTH,))
    calibrations = calibrations_of(scenario.world(seed).robot.cameras)
    view = DepthView.of(calibrations[DEPTH], DEPTH)
    before: Planar | None = None
    number = 0
    for world, observation in blind_drive(scenario, seed):
        if DEPTH not in observation.images:
            continue
        number += 1
        frame = make_frame(observation, calibrations, before)
        # Images are made when first asked for, which is not to count as the tracker's time.
        frame.depth(DEPTH), frame.rgb(DEPTH_COLOUR)
        before = observation.odometry
        truth = world.truth(DEPTH)
        yield DriveMoment(number, frame, tuple(_standers(truth, view)), truth.robot, observation)


def with_cameras(scenario: Scenario, cameras: Mapping[str, Mapping[str, object]]) -> Scenario:
    """Give the scenario's robot cameras, by name, in place of those that it has by these names."""
    data = scenario.robot.model_dump(exclude_unset=True)
    cameras = {**data.get("cameras", {}), **cameras}
    robot = RobotSpec.model_validate(data | {"cameras": cameras})
    return replace(scenario, spec=scenario.spec.model_copy(update={"robot": robot}))


def _standers(truth: Truth, view: DepthView) -> Iterator[Stander]:
    for person in truth.people:
        is_counted = person.visible_px > LEAST_PX and person.distance_m <= FARTHEST_M
        yield Stander(
            id=person.id,
            place_m=truth.robot.locate(person.position_m),
            surface_m=_surface(person, truth, view) if is_counted else None,
            distance_m=person.distance_m,
            inside=person.inside_fraction,
            hidden=person.occluded_fraction,
            is_counted=is_counted,
            box=person.visible_box,
            whole_box=person.box,
        )


def _surface(person: PersonTruth, truth: Truth, view: DepthView) -> tuple[float, float] | None:
    """Find the surface at the middle of a person's box, which the thesis takes for where the person is."""
    if person.visible_box is None:
        return None
    left, top, width, height = person.visible_box
    middle = left + width / 2.0
    depths = truth.depth_m[_inside(top, height), _inside(left, width)]
    is_person = truth.instance[_inside(top, height), _inside(left, width)] == person.id
    if not is_person.any():
        return None
    z = float(np.median(depths[is_person]))
    forward, aside = view.on_floor(np.array([(middle - view.centre_u) * z / view.focal_px]), np.array([z]))[0]
    return float(forward), float(aside)


def _inside(first: float, size: float) -> slice:
    """Give the middle half of a box's rows or columns."""
    start = max(round(first + size / 4.0), 0)
    return slice(start, max(round(first + size * 3.0 / 4.0), start) + 1)
