"""The closed loop: senses become tracks, tracks become a command, and the command moves the world."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from behaviours.behaviour import Behaviour
from behaviours.command import Command
from behaviours.sight import SeenPerson, Sight
from sim.observation import Observation
from sim.robot.peoplebot import WHEEL_DISTANCE_M, Planar
from sim.robot.sonar import SONAR_ANGLE_RAD
from sim.truth import Truth
from sim.world import World
from tracker.frame import Frame
from tracker.particles import Particles
from tracker.people import Tracker
from tracker.track import Status, Track


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tick:
    """One turn of the loop: everything that was sensed, true, tracked and decided at one instant.

    Attributes:
        frame: 1, 2, ...
        observation: what the robot sensed.
        truth: what was true.
        tracks: what the tracker made of the images.
        particles: its samples by track id, 0 being the detector's.
        mode: what the behaviour was doing, such as "search" or "follow".
        command: what the robot was told to do next.
    """

    frame: int
    observation: Observation
    truth: Truth
    tracks: tuple[Track, ...]
    particles: Mapping[int, Particles]
    mode: str
    command: Command


def closed_loop(world: World, tracker: Tracker, behaviour: Behaviour, frames: int) -> Iterator[Tick]:
    """Run the loop for a number of frames, from the world's present instant on."""
    before: Planar | None = None
    for frame in range(1, frames + 1):
        observation = world.observe()
        tracks = tracker.update(make_frame(observation, before))
        before = observation.odometry
        command = behaviour.command(make_sight(observation, tracks))
        yield Tick(
            frame=frame,
            observation=observation,
            truth=world.truth(),
            tracks=tracks,
            particles=tracker.particles,
            mode=behaviour.mode,
            command=command,
        )
        if frame < frames:
            world.step(command.linear_m_s, command.angular_rad_s)


def make_frame(observation: Observation, before: Planar | None) -> Frame:
    """Give the tracker its images, and how the odometry moved since the pose before (None: unknown)."""
    turn, advance = None, None
    if before is not None:
        now = observation.odometry
        turn = math.remainder(now.heading - before.heading, math.tau)
        dx, dy = now.x - before.x, now.y - before.y
        advance = dx * math.cos(before.heading) + dy * math.sin(before.heading)
    return Frame(
        thermal=observation.thermal,
        time_s=observation.time_s,
        colour=observation.colour,
        turn_rad=turn,
        advance_m=advance,
    )


def make_sight(observation: Observation, tracks: tuple[Track, ...]) -> Sight:
    """Give the behaviour what it steers by: confirmed tracks, sonar and the wheels' speed."""
    height, width = observation.thermal.shape
    people = tuple(
        see_person(track, width, height) for track in tracks if track.status is not Status.TENTATIVE
    )
    left, right = observation.wheel_speeds_m_s
    return Sight(
        time_s=observation.time_s,
        people=people,
        sonar_m=observation.sonar_m,
        sonar_angle_rad=SONAR_ANGLE_RAD,
        linear_m_s=(left + right) / 2.0,
        angular_rad_s=(right - left) / WHEEL_DISTANCE_M,
    )


def see_person(track: Track, width: int, height: int) -> SeenPerson:
    """Express a track's box in shares of the image."""
    left, top, box_width, box_height = track.box
    return SeenPerson(
        id=track.id,
        x=(left + box_width / 2.0 - (width - 1) / 2.0) / (width / 2.0),
        height=box_height / height,
        top=(top + 0.5) / height,
        bottom=(top + box_height + 0.5) / height,
        confidence=track.confidence,
        is_visible=track.status is not Status.TOTALLY_OCCLUDED,
    )
