"""What a world needs of its physics, whatever moves the robot."""

from __future__ import annotations

import functools
import importlib.util
import logging
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Final, Literal, Protocol, get_args, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.physics.solid_shapes import PartKey
from peopleboy.sim.physics.urdf import MISSING_PHYSICS
from peopleboy.sim.shapes.shape_table import VisualShape
from peopleboy.sim.shapes.shapes import UPRIGHT, Quaternion, Shape, Vector

PhysicsName = Literal["bullet", "kinematic"]
PHYSICS: Final[tuple[PhysicsName, ...]] = get_args(PhysicsName)


class Physics(Protocol):
    """Bodies by name, of which one may drive, and what they hit.

    Parts are numbered in the order in which they were created; the number never changes. The frame of a
    part is the frame in which its shapes were given. Every method that takes a name raises BadInput if no
    body has it.
    """

    def close(self) -> None:
        """Free the world; closing twice is harmless."""
        ...

    def add_part(
        self,
        name: str,
        shapes: Sequence[Shape],
        *,
        position: Vector = (0.0, 0.0, 0.0),
        orientation: Quaternion = UPRIGHT,
        visible: bool = True,
        solid: bool = True,
    ) -> None:
        """Add a body of one part that stays where it is put, however hard it is hit.

        An invisible part is drawn by no renderer; one that is not solid is passed by rays and bodies.

        Raises:
            BadInput: the name is taken, there are no shapes, or a mesh is missing or cannot be read.
        """
        ...

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
        """Add the robot or thing of a URDF file.

        Args:
            name: what to call it.
            path: the file; a relative one that does not exist is looked up in pybullet_data.
            position: [m] of the base link's frame in the world.
            orientation: of the base link's frame, world from base.
            fixed: held in place for good.
            scale: factor on all lengths.

        Raises:
            BadInput: the name is taken, or the file is missing or broken.
        """
        ...

    def set_pose(self, name: str, position: Vector, orientation: Quaternion) -> None:
        """Put a body's base frame at `position` [m] and `orientation` in the world, at rest."""
        ...

    def set_poses(self, names: Sequence[str], positions: ArrayLike, orientations: ArrayLike) -> None:
        """Put base frames of N bodies at positions (N, 3) [m] and orientations (N, 4), as `set_pose` does."""
        ...

    def set_hidden(self, name: str, hidden: bool) -> None:
        """Take a body out of images, rays and contacts, or put it back where it was last placed.

        Raises:
            BadInput: physics moves the body, so that there is no place to put it back to.
        """
        ...

    def hidden_parts(self) -> NDArray[np.bool_]:
        """(P,) which parts are hidden now."""
        ...

    def step(self) -> None:
        """Advance the world by one physics step."""
        ...

    def set_joint_speeds(self, name: str, speeds: Mapping[str, float], max_torque_nm: float) -> None:
        """Drive joints at speeds [rad/s] with at most this torque [N m] each.

        Raises:
            BadInput: the body has no such joint.
        """
        ...

    def joint_states(self, name: str, joints: Sequence[str]) -> tuple[Matrix, Matrix]:
        """Positions (J,) [rad] and speeds (J,) [rad/s] of the named joints.

        Raises:
            BadInput: the body has no such joint.
        """
        ...

    def velocity(self, name: str) -> tuple[Matrix, Matrix]:
        """Linear (3,) [m/s] and angular (3,) [rad/s] velocity of a body that moves by itself, world frame."""
        ...

    def parts(self) -> tuple[PartKey, ...]:
        """All parts, in the order of their numbers."""
        ...

    def pose(self, name: str) -> Matrix:
        """(4, 4) world from the frame of the body's base, a copy; where it will reappear if it is hidden."""
        ...

    def part_poses(self) -> Matrix:
        """(P, 4, 4) world from part, a copy; hidden parts are far below the floor."""
        ...

    def visual_shapes(self) -> list[VisualShape]:
        """Every shape that a renderer should draw, in the order of the parts."""
        ...

    def cast_rays(
        self, from_m: ArrayLike, to_m: ArrayLike, ignore: str | None = None
    ) -> tuple[Matrix, NDArray[np.int64]]:
        """Find the nearest solid along rays, which pass through the body called `ignore`.

        Args:
            from_m: (R, 3) [m] where rays start, world frame.
            to_m: (R, 3) [m] where they end, world frame.
            ignore: a body that the rays do not see, such as the one that sends them out.

        Returns:
            fraction: (R,) of the way at which a ray hits, 1 where it hits nothing.
            part: (R,) part that is hit, -1 where none.
        """
        ...

    def touching(self, name: str) -> set[str]:
        """Names of all that a body touched during the last step."""
        ...


@runtime_checkable
class Rasteriser(Protocol):
    """Physics that can draw, by a renderer of its own."""

    def parts(self) -> tuple[PartKey, ...]:
        """All parts, in the order of their numbers."""
        ...

    def camera_image(
        self, camera: Pinhole, world_from_camera: Matrix, only: Collection[str] | None = None
    ) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Draw the world, or only the bodies of some names: parts (H, W) and depths (H, W) [m]."""
        ...


@functools.cache
def default_physics() -> PhysicsName:
    """Return PyBullet, or kinematic physics where PyBullet is not installed; log a notice then, once."""
    if importlib.util.find_spec("pybullet") is not None:
        return "bullet"
    logging.getLogger(__name__).warning("peopleboy: PyBullet is not installed; physics is kinematic")
    return "kinematic"


def check_physics(name: PhysicsName) -> None:
    """Refuse physics that cannot be opened here, without loading them.

    Raises:
        BadInput: PyBullet is asked for and not installed.
    """
    if name == "bullet" and importlib.util.find_spec("pybullet") is None:
        raise BadInput(MISSING_PHYSICS)


def open_physics(name: PhysicsName, physics_hz: int) -> Physics:
    """Open an empty world.

    Raises:
        BadInput: PyBullet is asked for and not installed.
    """
    if name == "kinematic":
        from peopleboy.sim.physics.kinematic import Kinematic

        return Kinematic(physics_hz=physics_hz)
    from peopleboy.sim.physics.bullet import Bullet  # here, as the other one does without PyBullet

    return Bullet(physics_hz=physics_hz)
