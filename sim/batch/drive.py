"""The robots of many worlds: one control step of their wheels, with the people whom they may run into."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.batch.batch_people import BatchWalks
from peopleboy.sim.batch.joined_worlds import JoinedWorlds, slice_world
from peopleboy.sim.physics.kinematic import Kinematic
from peopleboy.sim.physics.solid_shapes import Array, Placements, refresh
from peopleboy.sim.physics.vehicle import Vehicle, VehicleMotion, advance
from peopleboy.sim.robot.peoplebot import Gears, approach_target, count_travel
from peopleboy.sim.robot.robot_body import WHEEL_RADIUS_M, wheel_speeds
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.sim.world import World

_wheel_speeds = njit(cache=True)(wheel_speeds)


class BatchCapsules(NamedTuple):
    """Q people of all worlds, one world after the other.

    Attributes:
        first: (B + 1,) where each world's begin.
        body: (Q,) number of the upright capsule that stands for a person, within its world.
        is_solid: (Q,) whether it is there to be met.
        middle_m: (Q,) [m] height of its middle.
        before, after: (Q, 2) [m] where it stands at the start and at the end of the step.
    """

    first: Numbers
    body: Numbers
    is_solid: NDArray[np.bool_]
    middle_m: Array
    before: Array
    after: Array


@njit(cache=True, nogil=True)
def drive_step(
    active: Numbers,
    joined: JoinedWorlds,
    vehicle: Vehicle,
    gears: Gears,
    noise_m: Array,
    people: BatchCapsules,
    dt_s: float,
    steps: int,
    touched: NDArray[np.bool_],
) -> None:
    """Do what `World.step` does physics step by physics step, for the worlds of some numbers.

    Args:
        active: (G,) numbers of the worlds.
        joined: changed in place.
        vehicle: all robots.
        gears: of all robots, with worlds first; `command`, `turned` and `odometry` are changed in place.
        noise_m: (G, 2) [m/sqrt(m)] of the encoders in this step.
        people: who are placed, all of them.
        dt_s: [s] length of a physics step.
        steps: how many of them.
        touched: one for each body of `joined`, gets True for what its robot touched.
    """
    for row in range(len(active)):
        world = active[row]
        bodies, solids = slice_world(joined, world)
        own, motion, robot = joined.own[world], _motion_of(joined.motion, world), _gears_of(gears, world)
        first, end = joined.first_body[world], joined.first_body[world + 1]
        met = np.zeros(end - first, np.bool_)
        for k in range(steps):
            if approach_target(robot, dt_s):
                left, right = _wheel_speeds(robot.command[0], robot.command[1])
                motion.speeds[0], motion.speeds[1] = left / WHEEL_RADIUS_M, right / WHEEL_RADIUS_M
            _move_people(people, world, (k + 1) / steps, bodies)
            refresh(bodies, solids)
            met[:] = False
            advance(vehicle, motion, bodies, solids, own, dt_s, met)
            for body in range(end - first):
                touched[first + body] |= met[body]
        bodies.stale[own] = True
        count_travel(robot, motion.angles, noise_m[row])
        _put_people(people, world, bodies)


@njit(cache=True)
def _motion_of(motion: VehicleMotion, world: int) -> VehicleMotion:
    return VehicleMotion(
        motion.pose[world], motion.angles[world], motion.speeds[world], motion.velocity[world]
    )  # fmt: skip


@njit(cache=True)
def _gears_of(gears: Gears, world: int) -> Gears:
    return Gears(
        gears.command[world], gears.target[world], gears.rise[world], gears.turned[world],
        gears.odometry[world],
    )  # fmt: skip


@njit(cache=True)
def _move_people(people: BatchCapsules, world: int, share: float, bodies: Placements) -> None:
    """Put solid people where they are when this share of the step has passed."""
    for q in range(people.first[world], people.first[world + 1]):
        if people.is_solid[q]:
            before, after = people.before[q], people.after[q]
            x = before[0] + share * (after[0] - before[0])
            y = before[1] + share * (after[1] - before[1])
            _place(bodies, people.body[q], x, y, people.middle_m[q])


@njit(cache=True)
def _put_people(people: BatchCapsules, world: int, bodies: Placements) -> None:
    """Put solid people where they are when the step is over, to the last bit."""
    for q in range(people.first[world], people.first[world + 1]):
        if people.is_solid[q]:
            _place(bodies, people.body[q], people.after[q, 0], people.after[q, 1], people.middle_m[q])


@njit(cache=True)
def _place(bodies: Placements, body: int, x: float, y: float, z: float) -> None:
    place = bodies.places[body]
    place[0], place[1], place[2] = x, y, z
    place[3], place[4], place[5], place[6] = 0.0, 0.0, 0.0, 1.0
    bodies.stale[body] = True


class BatchDrive:
    """The robots of B worlds, whose gears lie in arrays of all of them from now on.

    Args:
        worlds: of a batch.
        walks: where everybody goes.
        joined: where all is that they may run into.
        vehicle: what they roll on.

    Attributes:
        gears: of all of them, with worlds first.
    """

    def __init__(
        self, worlds: Sequence[World], walks: BatchWalks, joined: JoinedWorlds, vehicle: Vehicle
    ) -> None:
        self._robots = [world.robot for world in worlds]
        self._walks, self._joined, self._vehicle = walks, joined, vehicle
        self._capsules = _capsules(worlds, walks)
        self._bodies = joined.first_body[walks.world] + self._capsules.body
        self.gears = Gears(*map(np.stack, zip(*(robot.gears for robot in self._robots), strict=True)))
        for number, robot in enumerate(self._robots):
            robot.rebind(Gears(*(array[number] for array in self.gears)))
        drives = [robot.limits for robot in self._robots]
        self._limits = np.array([each.limits for each in drives])
        self._rise = np.array([each.rise for each in drives])
        self._noise_m = np.array([each.encoder_noise_m for each in drives])
        config = worlds[0].config
        self._dt_s, self._steps = 1.0 / config.physics_hz, config.physics_hz // config.control_hz

    def command(self, active: Numbers, commands: Array) -> None:
        """Ask for velocities (G, 2) [m/s, rad/s] in worlds of some numbers (G,), as `PeopleBot.command`.

        Raises:
            BadInput: a command is not finite.
        """
        if not np.isfinite(commands).all():
            raise BadInput("velocity commands must be finite")
        limits = self._limits[active]
        self.gears.target[active] = np.clip(commands, -limits, limits)
        self.gears.rise[active] = self._rise[active]

    @property
    def are_solid(self) -> NDArray[np.bool_]:
        """(Q,) whether each of all people is there to be met."""
        are_solid: NDArray[np.bool_] = ~self._joined.bodies.hidden[self._bodies]
        return are_solid

    def drive(self, active: Numbers, before: Array) -> NDArray[np.bool_]:
        """Let physics do a control step, and count what the wheels have turned.

        Args:
            active: (G,) numbers of the worlds.
            before: (Q, 2) [m] where all people stood at its start.

        Returns:
            One for each body of all worlds: whether a robot touched it.
        """
        noise = np.empty((len(active), 2))
        for row, number in enumerate(active.tolist()):
            self._robots[number].draw_noise(noise[row])
        noise *= self._noise_m[active, None]
        # Packed, as those of a single person are anyway, or kernels would be compiled for both layouts.
        before, after = np.ascontiguousarray(before), np.ascontiguousarray(self._walks.records["position"])
        capsules = self._capsules._replace(is_solid=self.are_solid, before=before, after=after)
        touched = np.zeros(len(self._joined.bodies.places), np.bool_)
        drive_step(
            active, self._joined, self._vehicle, self.gears, noise, capsules, self._dt_s, self._steps, touched
        )
        return touched


def _capsules(worlds: Sequence[World], walks: BatchWalks) -> BatchCapsules:
    """By what people are met; where it is comes with each step."""
    people = [person for world in worlds for person in world.crowd.people]
    places = walks.records["position"]
    return BatchCapsules(
        first=walks.first,
        body=np.array([number for world in worlds for number in _capsule_numbers(world)], np.int64),
        is_solid=np.zeros(len(people), np.bool_),
        middle_m=np.array([person.config.height_m for person in people]) / 2.0,
        before=places,
        after=places,
    )


def _capsule_numbers(world: World) -> list[int]:
    assert isinstance(world.physics, Kinematic)
    return [world.physics.number_of(name) for name in world.crowd.capsules]
