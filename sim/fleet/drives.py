"""The wheels of many robots, driven together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.fleet.drive_worlds import Capsules, drive_worlds
from peopleboy.sim.fleet.side_by_side import Joined
from peopleboy.sim.fleet.walk_worlds import Walks
from peopleboy.sim.physics.kinematic import Kinematic
from peopleboy.sim.physics.solid_shapes import Array
from peopleboy.sim.physics.vehicle import Vehicle
from peopleboy.sim.robot.peoplebot import Gears
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.sim.world import World


class Drives:
    """The robots of B worlds, whose gears lie in arrays of all of them from now on.

    Args:
        worlds: of a fleet.
        walks: where everybody goes.
        joined: where all is that they may run into.
        vehicle: what they roll on.

    Attributes:
        gears: of all of them, with worlds first.
    """

    def __init__(self, worlds: Sequence[World], walks: Walks, joined: Joined, vehicle: Vehicle) -> None:
        self._robots = [world.robot for world in worlds]
        self._walks, self._joined, self._vehicle = walks, joined, vehicle
        self._capsules = _capsules(worlds, walks)
        self._bodies = joined.first_body[walks.world] + self._capsules.body
        self.gears = Gears(*map(np.stack, zip(*(robot.gears for robot in self._robots), strict=True)))
        for number, robot in enumerate(self._robots):
            robot.lay_into(Gears(*(array[number] for array in self.gears)))
        drives = [robot.limits for robot in self._robots]
        self._limits = np.array([each.limits for each in drives])
        self._rise = np.array([each.rise for each in drives])
        self._noise_m = np.array([each.encoder_noise_m for each in drives])
        config = worlds[0].config
        self._dt_s, self._steps = 1.0 / config.physics_hz, config.physics_hz // config.control_hz

    def command(self, going: Numbers, commands: Array) -> None:
        """Ask for velocities (G, 2) [m/s, rad/s] in worlds of some numbers (G,), as `PeopleBot.command`.

        Raises:
            BadInput: a command is not finite.
        """
        if not np.isfinite(commands).all():
            raise BadInput("velocity commands must be finite")
        limits = self._limits[going]
        self.gears.target[going] = np.clip(commands, -limits, limits)
        self.gears.rise[going] = self._rise[going]

    @property
    def are_solid(self) -> NDArray[np.bool_]:
        """(Q,) whether each of all people is there to be met."""
        are_solid: NDArray[np.bool_] = ~self._joined.bodies.hidden[self._bodies]
        return are_solid

    def drive(self, going: Numbers, before: Array) -> NDArray[np.bool_]:
        """Let physics do a control step, and count what the wheels have turned.

        Args:
            going: (G,) numbers of the worlds.
            before: (Q, 2) [m] where all people stood at its start.

        Returns:
            One for each body of all worlds: whether a robot touched it.
        """
        noise = np.empty((len(going), 2))
        for row, number in enumerate(going.tolist()):
            self._robots[number].draw_noise(noise[row])
        noise *= self._noise_m[going, None]
        # Packed, as those of a single person are anyway, or kernels would be compiled for both layouts.
        before, after = np.ascontiguousarray(before), np.ascontiguousarray(self._walks.records["position"])
        capsules = self._capsules._replace(is_solid=self.are_solid, before=before, after=after)
        touched = np.zeros(len(self._joined.bodies.places), np.bool_)
        drive_worlds(
            going, self._joined, self._vehicle, self.gears, noise, capsules, self._dt_s, self._steps, touched
        )
        return touched


def _capsules(worlds: Sequence[World], walks: Walks) -> Capsules:
    """By what people are met; where it is comes with each step."""
    people = [person for world in worlds for person in world.crowd.people]
    places = walks.records["position"]
    return Capsules(
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
