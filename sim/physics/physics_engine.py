"""The interface of a world to its physics, for any engine."""

import functools
import importlib.util
import logging
from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Final, Literal, Protocol, Self, TypeVar, get_args, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.physics.solid_shapes import PartKey
from peopleboy.sim.physics.urdf import MISSING_PHYSICS
from peopleboy.sim.shapes.shape_table import VisualShape
from peopleboy.sim.shapes.shapes import UPRIGHT, Quaternion, Shape, ShapeKind, Vector, load_triangles

PhysicsName = Literal["bullet", "kinematic"]
PHYSICS: Final[tuple[PhysicsName, ...]] = get_args(PhysicsName)


B = TypeVar("B")


class BodiesByName(dict[str, B]):
    """Bodies by name.

    Raises:
        BadInput: the name is unknown.
    """

    def __missing__(self, name: str) -> B:
        known = f"choose from {', '.join(self)}" if self else "the world has no bodies"
        raise BadInput(f"unknown body {name!r}; {known}")

    def check_new(self, name: str) -> None:
        """Check that a name is not taken.

        Raises:
            BadInput: the name is taken.
        """
        if name in self:
            raise BadInput(f"body {name!r} exists already; choose another name")


class Physics(ABC):
    """Physics of bodies by name, one of which can drive; use it as a context manager, or close it.

    Parts are numbered in the order of creation; the number never changes. The frame of a part is the frame in
    which its shapes were given. Every method that takes a name raises BadInput if it is unknown.
    """

    def __init__(self) -> None:
        self._parts: list[PartKey] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @abstractmethod
    def close(self) -> None:
        """Free the world; closing twice is harmless."""

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
        """Add a static body of one part.

        Renderers do not draw an invisible part; rays and bodies pass through one that is not solid.

        Raises:
            BadInput: the name is taken, there are no shapes, or a mesh is missing or cannot be read.
        """
        self._check_new(name)
        if not shapes:
            raise BadInput(f"body {name!r} has no shapes; give at least one")
        for shape in shapes:
            if shape.kind == ShapeKind.MESH and not (shape.mesh and shape.mesh.is_file()):
                raise BadInput(f"body {name!r}: mesh {shape.mesh} not found; give an OBJ, STL or DAE file")
            if shape.mesh is not None:
                load_triangles(shape.mesh)
        self._add_shapes(name, shapes, visible, solid)
        self.set_pose(name, position, orientation)

    @abstractmethod
    def _check_new(self, name: str) -> None: ...

    @abstractmethod
    def _add_shapes(self, name: str, shapes: Sequence[Shape], visible: bool, solid: bool) -> None:
        """Add a body of one part, with valid shapes."""

    @abstractmethod
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
            name: name of the body.
            path: path of the file; a relative one that does not exist is searched for in pybullet_data.
            position: [m] position of the base link's frame in the world.
            orientation: orientation of the base link's frame, world from base.
            fixed: whether the body is fixed in place.
            scale: factor on all lengths.

        Raises:
            BadInput: the name is taken, or the file is missing or broken.
        """

    @abstractmethod
    def set_pose(self, name: str, position: Vector, orientation: Quaternion) -> None:
        """Place a body's base frame at `position` [m] and `orientation` in the world, at rest."""

    @abstractmethod
    def set_poses(self, names: Sequence[str], positions: ArrayLike, orientations: ArrayLike) -> None:
        """Place base frames of N bodies at positions (N, 3) [m] and orientations (N, 4), like `set_pose`."""

    @abstractmethod
    def shift(self, name: str, offset_m: Vector) -> None:
        """Move a body that moves by itself by an offset, world frame; it keeps its velocity."""

    @abstractmethod
    def set_hidden(self, name: str, hidden: bool) -> None:
        """Remove a body from images, rays and contacts, or restore it at its last pose.

        Raises:
            BadInput: physics moves the body.
        """

    @abstractmethod
    def hidden_parts(self) -> NDArray[np.bool_]:
        """Return (P,) whether a part is hidden."""

    @abstractmethod
    def step(self) -> None:
        """Advance the world by one physics step."""

    @abstractmethod
    def set_joint_speeds(self, name: str, speeds: Mapping[str, float], max_torque_nm: float) -> None:
        """Drive joints at speeds [rad/s] with at most this torque [N m] each.

        Raises:
            BadInput: the body has no such joint.
        """

    @abstractmethod
    def joint_states(self, name: str, joints: Sequence[str]) -> tuple[Matrix, Matrix]:
        """Return positions (J,) [rad] and speeds (J,) [rad/s] of the named joints.

        Raises:
            BadInput: the body has no such joint.
        """

    @abstractmethod
    def velocity(self, name: str) -> tuple[Matrix, Matrix]:
        """Return linear (3,) [m/s] and angular (3,) [rad/s] velocity of a moving body, world frame."""

    def parts(self) -> tuple[PartKey, ...]:
        """All parts, in the order of their numbers."""
        return tuple(self._parts)

    @abstractmethod
    def pose(self, name: str) -> Matrix:
        """Return a copy of the pose (4, 4), world from base frame; of a hidden body its last pose."""

    @abstractmethod
    def part_poses(self) -> Matrix:
        """Return a copy of the poses (P, 4, 4), world from part; hidden parts are far below the floor."""

    @abstractmethod
    def visual_shapes(self) -> list[VisualShape]:
        """Return all visible shapes, in the order of the parts."""

    @abstractmethod
    def cast_rays(
        self, from_m: ArrayLike, to_m: ArrayLike, ignore: str | None = None
    ) -> tuple[Matrix, NDArray[np.int64]]:
        """Return the nearest solid along rays, which pass through the body `ignore`.

        Args:
            from_m: (R, 3) [m] start points, world frame.
            to_m: (R, 3) [m] end points, world frame.
            ignore: a body that rays ignore, such as the one that carries the sensor.

        Returns:
            fraction: (R,) hit distance as a fraction of the ray, 1 without a hit.
            part: (R,) number of the hit part, -1 for none.
        """

    @abstractmethod
    def touching(self, name: str) -> set[str]:
        """Return the names of all bodies that a body touched during the last step."""


@runtime_checkable
class Rasteriser(Protocol):
    """Physics with a built-in renderer."""

    def parts(self) -> tuple[PartKey, ...]:
        """All parts, in the order of their numbers."""
        ...

    def camera_image(
        self, camera: Pinhole, world_from_camera: Matrix, only: Collection[str] | None = None
    ) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Render the world, or only some bodies: parts (H, W) and depths (H, W) [m]."""
        ...


@functools.cache
def default_physics() -> PhysicsName:
    """Return PyBullet, or kinematic physics with a notice, once, if PyBullet is not installed."""
    if importlib.util.find_spec("pybullet") is not None:
        return "bullet"
    logging.getLogger(__name__).warning("PyBullet is not installed; physics is kinematic")
    return "kinematic"


def check_physics(name: PhysicsName) -> None:
    """Check that physics is available, without loading it.

    Raises:
        BadInput: PyBullet is requested and not installed.
    """
    if name == "bullet" and importlib.util.find_spec("pybullet") is None:
        raise BadInput(MISSING_PHYSICS)
