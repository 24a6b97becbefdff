"""The wheels of many robots, driven together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.fleet.drive_worlds import Capsules, drive_worlds
from peopleboy.sim.fleet.side_by_side import Joined
from peopleboy.sim.physics.kinematic.solids import Array
from peopleboy.sim.physics.kinematic.vehicle import Vehicle
from peopleboy.sim.robot.peoplebot import Gears
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.sim.world import World


class Drives:
    """The robots of B worlds, whose gears lie in arrays of all of them from now on.

    Args:
        worlds: of a fleet.
        joined: where all is that they may run into.
        vehicle: what they roll on.

    Attributes:
        gears: of all of them, with worlds first.
    """

    def __init__(self, worlds: Sequence[World], joined: Joined, vehicle: Vehicle) -> None:
        self._robots = [world.robot for world in worlds]
        self._joined, self._vehicle = joined, vehicle
        self.gears = Gears(*map(np.stack, zip(*(robot.gears for robot in self._robots), strict=True)))
        for number, robot in enumerate(self._robots):
            robot.lay_into(Gears(*(array[number] for array in self.gears)))
        limits = [robot.limits for robot in self._robots]
        self._limits, self._rise = (
            np.array([each.limits for each in limits]),
            np.array([each.rise for each in limits]),
        )
        self._noise_m = np.array([each.encoder_noise_m for each in limits])
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

    def drive(self, going: Numbers, capsules: Capsules) -> NDArray[np.bool_]:
        """Let physics do a control step, and count what the wheels have turned.

        Returns:
            One for each body of all worlds: whether a robot touched it.
        """
        noise = np.empty((len(going), 2))
        for row, number in enumerate(going.tolist()):
            self._robots[number].draw_noise(noise[row])
        noise *= self._noise_m[going, None]
        touched = np.zeros(len(self._joined.bodies.places), np.bool_)
        drive_worlds(
            going, self._joined, self._vehicle, self.gears, noise, capsules, self._dt_s, self._steps, touched
        )
        return touched
