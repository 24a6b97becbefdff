"""All that is in a kinematic world at an instant, as arrays."""

from __future__ import annotations

from typing import NamedTuple

from peopleboy.sim.physics.kinematic.vehicle import Vehicle
from peopleboy.sim.physics.solids.solids import Array, Placements, Solids


class Motion(NamedTuple):
    """How the vehicle stands and moves.

    Attributes:
        pose: (3,) x, y [m], heading [rad].
        angles, speeds: (2,) [rad], [rad/s] of the left and the right wheel.
        velocity: (3,) [m/s], [m/s], [rad/s] in the last step, world frame.
    """

    pose: Array
    angles: Array
    speeds: Array
    velocity: Array


class State(NamedTuple):
    """A kinematic world with its vehicle, whose body has the number `own`."""

    bodies: Placements
    solids: Solids
    motion: Motion
    vehicle: Vehicle
    own: int
