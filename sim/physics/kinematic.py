"""Kinematic physics without PyBullet: static bodies, and a vehicle that rolls without slip on two wheels."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.geometry.vectors import multiply
from peopleboy.sim.physics.physics_engine import BodiesByName, Physics
from peopleboy.sim.physics.solid_shapes import PartKey, PlacedBodies, cast
from peopleboy.sim.physics.urdf import find_model, read_links
from peopleboy.sim.physics.vehicle import (
    Vehicle,
    VehicleMotion,
    VehicleState,
    advance,
    make_vehicle,
    place_on_floor,
    wheels_of,
)
from peopleboy.sim.shapes.shape_table import VisualShape, as_given
from peopleboy.sim.shapes.shapes import UPRIGHT, Quaternion, Shape, Vector

_LINK = "link0"  # PyBullet's name for it


@dataclass(slots=True, eq=False)
class _Rolling:
    """The one body that moves by itself.

    Attributes:
        body: number of the body.
        vehicle: outline and wheels.
        joints: names of the joints of the left and the right wheel.
        wheels: part numbers of the wheels.
        motion: pose and motion.
    """

    body: int
    vehicle: Vehicle
    joints: tuple[str, str]
    wheels: tuple[int, int]
    motion: VehicleMotion


class Kinematic(Physics):
    """A kinematic world with bodies by name.

    There may be one vehicle. It stays upright on z = 0, and moves with its wheels instantly and without slip,
    independent of torque. At the end of a step it is pushed out of solids, where its wheels slip. It does not
    push other bodies, and passes over planes and objects lower than its boxes.

    Attributes:
        numbers: numbers of the bodies by name, in the order of creation.
    """

    def __init__(self, *, physics_hz: int = 240) -> None:
        super().__init__()
        self._dt_s = 1.0 / physics_hz
        self.numbers = BodiesByName[int]()
        self._bodies = PlacedBodies()
        self._visible: list[VisualShape] = []
        self._touched = np.zeros(0, np.bool_)
        self._rolling: _Rolling | None = None

    def close(self) -> None:
        """Do nothing: there is nothing to free."""

    def add_urdf(
        self,
        name: str,
        path: Path | str,
        *,
        position: Vector = (0.0, 0.0, 0.0),
        orientation: Quaternion = UPRIGHT,
        fixed: bool = True,
        scale: float = 1.0,
    ) -> None:
        """See `Physics.add_urdf`; the only body that is not fixed must be a vehicle."""
        self.numbers.check_new(name)
        links = read_links(find_model(path), scale)
        first = len(self._parts)
        if not fixed:
            if self._rolling is not None:
                raise BadInput(f"body {name!r}: kinematic physics moves only one body")
            left, right = wheels_of(name, links)
            self._rolling = _Rolling(
                body=len(self.numbers),
                vehicle=make_vehicle(name, links),
                joints=(links[left].joint, links[right].joint),
                wheels=(first + left, first + right),
                motion=VehicleMotion(np.zeros(3), np.zeros(2), np.zeros(2), np.zeros(3)),
            )
        number = self._add_body(name)
        for k, link in enumerate(links):
            self._add_link(
                number, PartKey(name, k - 1, link.name), link.base_from_link, link.visible, link.solid
            )
        self.set_pose(name, position, orientation)

    def set_pose(self, name: str, position: Vector, orientation: Quaternion) -> None:
        """See `Physics.set_pose`; for the vehicle only position and heading on the floor are used."""
        number = self.numbers[name]
        rolling = self._rolling
        if rolling is not None and rolling.body == number:
            x, y, z, w = orientation
            heading = math.atan2(2.0 * (x * y + z * w), 1.0 - 2.0 * (y * y + z * z))
            rolling.motion.pose[:] = position[0], position[1], heading
            rolling.motion.velocity[:] = 0.0
            place_on_floor(rolling.motion.pose, self._bodies.places[number])
            self._bodies.stale[number] = True
            return
        self._bodies.put(number, position, orientation)

    def set_poses(self, names: Sequence[str], positions: ArrayLike, orientations: ArrayLike) -> None:
        """See `Physics.set_poses`; not for the vehicle."""
        self._bodies.put([self.numbers[name] for name in names], positions, orientations)

    def shift(self, name: str, offset_m: Vector) -> None:
        """See `Physics.shift`."""
        rolling = self._vehicle_called(name, ())
        rolling.motion.pose[:2] += offset_m[:2]
        place_on_floor(rolling.motion.pose, self._bodies.places[rolling.body])
        self._bodies.stale[rolling.body] = True

    def set_hidden(self, name: str, hidden: bool) -> None:
        """See `Physics.set_hidden`."""
        number = self.numbers[name]
        if self._rolling is not None and self._rolling.body == number:
            raise BadInput(f"body {name!r} is not fixed: it cannot be hidden")
        if self._bodies.hidden[number] != hidden:
            self._bodies.hidden[number], self._bodies.stale[number] = hidden, True

    def hidden_parts(self) -> NDArray[np.bool_]:
        """Return (P,) whether a part is hidden."""
        bodies, _ = self._bodies.now()
        return bodies.hidden[bodies.of_part]

    def step(self) -> None:
        """Roll the vehicle for one physics step, and push it out of solids."""
        bodies, solids = self._bodies.now()
        self._touched = np.zeros(len(bodies.places), np.bool_)
        rolling = self._rolling
        if rolling is None:
            return
        own = rolling.body
        if advance(rolling.vehicle, rolling.motion, bodies, solids, own, self._dt_s, self._touched):
            bodies.stale[own] = True

    def set_joint_speeds(self, name: str, speeds: Mapping[str, float], max_torque_nm: float) -> None:
        """Set wheel speeds [rad/s] for the next steps, at any positive torque."""
        rolling = self._vehicle_called(name, speeds)
        for joint, speed in speeds.items():
            rolling.motion.speeds[rolling.joints.index(joint)] = speed if max_torque_nm > 0.0 else 0.0

    def joint_states(self, name: str, joints: Sequence[str]) -> tuple[Matrix, Matrix]:
        """See `Physics.joint_states`."""
        rolling = self._vehicle_called(name, joints)
        chosen = [rolling.joints.index(joint) for joint in joints]
        return rolling.motion.angles[chosen], rolling.motion.speeds[chosen]

    def velocity(self, name: str) -> tuple[Matrix, Matrix]:
        """See `Physics.velocity`; for the origin of the base frame."""
        x, y, turn = self._vehicle_called(name, ()).motion.velocity.tolist()
        return np.array([x, y, 0.0]), np.array([0.0, 0.0, turn])

    def pose(self, name: str) -> Matrix:
        """See `Physics.pose`."""
        place = self._bodies.places[self.numbers[name]]
        return pose_matrices(place[:3], place[3:])

    def part_poses(self) -> Matrix:
        """See `Physics.part_poses`."""
        bodies, _ = self._bodies.now()
        poses = bodies.poses.copy()
        if self._rolling is not None:
            turn_wheels(poses, np.array(self._rolling.wheels, np.int64), self._rolling.motion.angles)
        return poses

    @property
    def wheels(self) -> tuple[int, int]:
        """Part numbers of the vehicle's left and right wheel; requires a vehicle."""
        assert self._rolling is not None
        return self._rolling.wheels

    def visual_shapes(self) -> list[VisualShape]:
        """Return all visible shapes, in the order of the parts."""
        return list(self._visible)

    def cast_rays(
        self, from_m: ArrayLike, to_m: ArrayLike, ignore: str | None = None
    ) -> tuple[Matrix, NDArray[np.int64]]:
        """See `Physics.cast_rays`; exact, and from outside of shapes only."""
        bodies, solids = self._bodies.now()
        starts, ends = np.asarray(from_m, np.float64), np.asarray(to_m, np.float64)
        found: tuple[Matrix, NDArray[np.int64]] = cast(
            starts, ends, bodies, solids, -1 if ignore is None else self.numbers[ignore]
        )
        return found

    def touching(self, name: str) -> set[str]:
        """See `Physics.touching`; for the vehicle only, without the floor."""
        self._vehicle_called(name, ())
        if not self._touched.any():
            return set()
        return self.names_of(self._touched)

    def names_of(self, flags: NDArray[np.bool_]) -> set[str]:
        """Return the names of the bodies with a flag (B,), in the order of creation."""
        return {name for name, number in self.numbers.items() if flags[number]}

    def state(self) -> VehicleState:
        """Return the state of the world, not copied; requires a vehicle."""
        assert self._rolling is not None
        bodies, solids = self._bodies.now()
        rolling = self._rolling
        return VehicleState(bodies, solids, rolling.motion, rolling.vehicle, rolling.body)

    def rebind(self, state: VehicleState) -> None:
        """Use other arrays for the state from now on; they must hold the same values already."""
        assert self._rolling is not None
        self._bodies.rebind(state.bodies, state.solids)
        self._rolling.motion = state.motion

    def _check_new(self, name: str) -> None:
        self.numbers.check_new(name)

    def _add_shapes(self, name: str, shapes: Sequence[Shape], visible: bool, solid: bool) -> None:
        key = PartKey(name, -1, _LINK)
        self._add_link(
            self._add_body(name), key, np.eye(4), shapes if visible else (), shapes if solid else ()
        )

    def _add_body(self, name: str) -> int:
        number = self.numbers[name] = self._bodies.add()
        return number

    def _add_link(
        self, number: int, key: PartKey, pose: Matrix, visible: Sequence[Shape], solid: Sequence[Shape]
    ) -> None:
        self._visible += [as_given(shape, len(self._parts)) for shape in visible]
        self._bodies.add_part(number, pose, solid)
        self._parts.append(key)

    def _vehicle_called(self, name: str, joints: Sequence[str] | Mapping[str, float]) -> _Rolling:
        """Return the vehicle; its name and joints must match."""
        number, rolling = self.numbers[name], self._rolling
        if rolling is None or rolling.body != number:
            raise BadInput(f"body {name!r} is fixed: kinematic physics moves vehicles only")
        for joint in joints:
            if joint not in rolling.joints:
                known = ", ".join(rolling.joints)
                raise BadInput(f"body {name!r}: unknown wheel joint {joint!r}; choose from {known}")
        return rolling


@njit(cache=True, nogil=True)
def turn_wheels(poses: Matrix, wheels: NDArray[np.int64], angles: Matrix) -> None:
    """Rotate parts (W,) among poses (P, 4, 4) about their y axes by angles (W,) [rad], in place."""
    turn, before = np.zeros((3, 3)), np.empty((3, 3))
    for k in range(len(wheels)):
        cos, sin = math.cos(angles[k]), math.sin(angles[k])
        turn[0, 0], turn[0, 2], turn[1, 1], turn[2, 0], turn[2, 2] = cos, sin, 1.0, -sin, cos
        for i in range(3):
            for j in range(3):
                before[i, j] = poses[wheels[k], i, j]
        multiply(before, turn, poses[wheels[k], :3, :3])
