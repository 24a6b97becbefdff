"""The closed loop: senses become tracks, tracks become a command, and the command moves the world."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import Behaviour
from peopleboy.behaviours.command import Command
from peopleboy.behaviours.percept import Percept, SeenPerson
from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.observation import Observation
from peopleboy.sim.robot.robot_body import WHEEL_DISTANCE_M
from peopleboy.sim.robot.sonar_units import SONAR_ANGLE_RAD
from peopleboy.sim.truth.truth import Truth
from peopleboy.tracker.boxes import image_shares
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Status, Track
from peopleboy.tracker.trackers import Tracker, explanation_of

# Ways between two images beyond what the drive can do in a quarter of a second are jumps of the odometry.
FARTHEST_TURN_RAD = math.radians(40.0)
FARTHEST_WAY_M = 0.2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tick:
    """One turn of the loop: everything that was sensed, true, tracked and decided at one instant.

    Attributes:
        frame: 1, 2, ...
        observation: what the robot sensed.
        truths: what was true, by camera that took an image at this instant; those of other cameras than
            `thermal` are made when first asked for, which must be before the next tick.
        tracks: what the tracker made of the images.
        explanation: what it told beyond its tracks, to be drawn by its type; None for nothing.
        mode: what the behaviour was doing, such as "search" or "follow".
        command: what the robot was told to do next.
        reason: why the behaviour was doing that.
        following: number of the track that the robot follows; None if it follows nobody.
    """

    frame: int
    observation: Observation
    truths: Mapping[str, Truth]
    tracks: tuple[Track, ...]
    explanation: object
    mode: str
    command: Command
    reason: str = ""
    following: int | None = None

    @property
    def truth(self) -> Truth:
        """What was true, boxes and masks in the thermal image."""
        return self.truths["thermal"]


class Stage(Protocol):
    """Where the robot is: a world, or one whose sensors have faults."""

    def observe(self) -> Observation:
        """Read every sensor once."""
        ...

    def truths(self) -> Mapping[str, Truth]:
        """Tell what is true at this instant, by camera that takes an image."""
        ...

    def step(self, linear_m_s: float, angular_rad_s: float, *, is_emergency: bool = False) -> None:
        """Drive the robot for one control step."""
        ...


class Eyes:
    """The tracker, and whether what it says can be relied on: images may stay out, and it may fail.

    Attributes:
        tracks: those of the newest image that was understood.
    """

    def __init__(self, tracker: Tracker) -> None:
        self._tracker = tracker
        self._newest: Observation | None = None
        self.tracks: tuple[Track, ...] = ()

    def look(self, observation: Observation) -> Percept:
        """Let the tracker see the images if they are new, and tell the behaviour.

        Images equal to the last ones to the bit are no new ones: the noise of a camera never repeats.
        """
        newest = self._newest
        if newest is not None and _is_same_image(newest, observation):
            age_s = observation.time_s - newest.time_s
            return make_percept(observation, self.tracks, image_age_s=age_s)
        before = None if newest is None else newest.odometry
        self._newest = observation
        try:
            self.tracks = self._tracker.update(make_frame(observation, before))
        except BadInput:
            raise
        except Exception as error:  # a robot among people outlives its tracker
            self.tracks = ()
            return make_percept(observation, (), fault=f"the tracker failed: {type(error).__name__}: {error}")
        return make_percept(observation, self.tracks)


def closed_loop(world: Stage, tracker: Tracker, behaviour: Behaviour, frames: int) -> Iterator[Tick]:
    """Run the loop for a number of frames, from the world's present instant on."""
    eyes = Eyes(tracker)
    for frame in range(1, frames + 1):
        observation = world.observe()
        command = behaviour.command(eyes.look(observation))
        yield Tick(
            frame=frame,
            observation=observation,
            truths=world.truths(),
            tracks=eyes.tracks,
            explanation=explanation_of(tracker),
            mode=behaviour.mode,
            command=command,
            reason=behaviour.reason,
            following=behaviour.following,
        )
        if frame < frames:
            world.step(command.linear_m_s, command.angular_rad_s, is_emergency=command.is_emergency)


def make_frame(observation: Observation, before: Planar | None) -> Frame:
    """Give the tracker its images, and how the odometry moved since the pose before (None: unknown).

    A jump that no wheels can make is unknown too.
    """
    turn, advance = None, None
    if before is not None:
        now = observation.odometry
        turn = math.remainder(now.heading - before.heading, math.tau)
        dx, dy = now.x - before.x, now.y - before.y
        advance = dx * math.cos(before.heading) + dy * math.sin(before.heading)
        if abs(turn) > FARTHEST_TURN_RAD or math.hypot(dx, dy) > FARTHEST_WAY_M:
            turn, advance = None, None
    return Frame(
        thermal=observation.images["thermal"],
        time_s=observation.time_s,
        colour=observation.images["colour"],
        turn_rad=turn,
        advance_m=advance,
    )


def make_percept(
    observation: Observation, tracks: tuple[Track, ...], *, image_age_s: float = 0.0, fault: str = ""
) -> Percept:
    """Give the behaviour what it steers by: confirmed tracks, sonar and the wheels' speed."""
    height, width = observation.images["thermal"].shape
    people = tuple(
        see_person(track, width, height) for track in tracks if track.status is not Status.TENTATIVE
    )
    left, right = observation.wheel_speeds_m_s
    return Percept(
        time_s=observation.time_s,
        people=people,
        sonar_m=observation.sonar_m,
        sonar_angle_rad=SONAR_ANGLE_RAD,
        linear_m_s=(left + right) / 2.0,
        angular_rad_s=(right - left) / WHEEL_DISTANCE_M,
        colour=observation.images["colour"],
        image_age_s=image_age_s,
        fault=fault,
    )


def _is_same_image(one: Observation, other: Observation) -> bool:
    return all(np.array_equal(one.images[name], other.images[name]) for name in ("thermal", "colour"))


def see_person(track: Track, width: int, height: int) -> SeenPerson:
    """Express a track's box in shares of the image."""
    shares = image_shares(track.box, width, height)
    return SeenPerson(
        id=track.id,
        x=shares.x,
        height=shares.height,
        top=shares.top,
        bottom=shares.bottom,
        confidence=track.confidence,
        is_visible=track.status is not Status.TOTALLY_OCCLUDED,
    )
