"""How cameras see: what lies behind their pixels, and the outlines of what stands alone before them."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.camera_geometry import CameraGeometry
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose
from peopleboy.sim.rendering.cover import Cover, count_cover
from peopleboy.sim.rendering.silhouette import silhouette_area, silhouette_bounds
from peopleboy.sim.rendering.view import NOBODY, View
from peopleboy.sim.shapes.shape_table import ShapeTable

if TYPE_CHECKING:
    from peopleboy.sim.physics.physics import Physics

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, weakref_slot=True)
class Scene:
    """All that there is to be seen at an instant.

    Attributes:
        renderer: name of what draws it for pinhole cameras.
        physics: the world.
        table: its visible shapes.
        world_from_part: (P, 4, 4).
        person_of_part: (P,) number of the person that a part belongs to, -1 for none.
        hidden: (P,) parts that are not there.
    """

    renderer: str
    physics: Physics
    table: ShapeTable
    world_from_part: Matrix
    person_of_part: NDArray[np.int64]
    hidden: Mask

    def only(self, parts: Mask) -> Scene:
        """The same scene with some parts (P,) alone, as those of one person."""
        return replace(self, person_of_part=np.where(parts, 0, NOBODY), hidden=~parts)


class Sight(ABC):
    """How the cameras of one geometry see; what `Flat` does is for pinholes alone.

    A new one has to say `view`. Its outlines follow from that, in whole pixels and no farther than the image;
    one that can say more of them, or says it sooner, does.
    """

    @abstractmethod
    def view(self, scene: Scene, camera: Any, world_from_camera: Matrix) -> View:
        """Draw what a camera sees of a scene; its pose is (4, 4), optical frame to world."""

    def bounds(self, scene: Scene, camera: Any, world_from_camera: Matrix, parts: Mask) -> Matrix:
        """Find rectangles around all that a camera would see of some parts (N, P) if nothing hid them.

        Returns:
            (N, 4) left, top, right, bottom [px]; all NaN where it would see nothing of them.
        """
        bounds = np.full((len(parts), 4), math.nan)
        for one, own in zip(bounds, parts, strict=True):
            v, u = np.nonzero(self.view(scene.only(own), camera, world_from_camera).cover)
            if len(u):
                one[:] = u.min() - 0.5, v.min() - 0.5, u.max() + 0.5, v.max() + 0.5
        return bounds

    def area(
        self, scene: Scene, camera: Any, world_from_camera: Matrix, parts: Mask, bounds: Sequence[float]
    ) -> int:
        """Count the pixels that some parts (P,) would fill if nothing hid them, within `bounds` of theirs."""
        if math.isnan(bounds[0]):
            return 0
        return int(np.count_nonzero(self.view(scene.only(parts), camera, world_from_camera).cover))

    def cover(self, view: View, owner_of_part: NDArray[np.int64], people: int, owners: int) -> Cover:
        """Count who covers whom, and find each person's visible pixels; arguments as in `count_cover`."""
        return count_cover(view.part, view.cover, owner_of_part, people, owners)


class Flat(Sight):
    """How a pinhole camera sees; its outlines go on beyond the image."""

    def __init__(self) -> None:
        # Poses in a camera's frame, of each scene that is still looked at: all boxes of a scene want them.
        self._poses: WeakKeyDictionary[Scene, dict[bytes, Matrix]] = WeakKeyDictionary()

    def view(self, scene: Scene, camera: Pinhole, world_from_camera: Matrix) -> View:
        """Draw by the scene's renderer."""
        from peopleboy.sim.rendering.render import render  # here, as kinds are told without PyBullet

        return render(
            scene.renderer, scene.physics, scene.table, camera, world_from_camera, scene.world_from_part,
            scene.person_of_part, scene.hidden,
        )  # fmt: skip

    def bounds(self, scene: Scene, camera: Pinhole, world_from_camera: Matrix, parts: Mask) -> Matrix:
        """See `silhouette_bounds`."""
        return silhouette_bounds(camera, scene.table, self._before(scene, world_from_camera), parts)

    def area(
        self, scene: Scene, camera: Pinhole, world_from_camera: Matrix, parts: Mask, bounds: Sequence[float]
    ) -> int:
        """See `silhouette_area`."""
        return silhouette_area(camera, scene.table, self._before(scene, world_from_camera), parts, bounds)

    def _before(self, scene: Scene, world_from_camera: Matrix) -> Matrix:
        """Give the poses (P, 4, 4) of a scene's parts in a camera's frame."""
        known, key = self._poses.setdefault(scene, {}), world_from_camera.tobytes()
        if key not in known:
            known[key] = invert_pose(world_from_camera) @ scene.world_from_part
        return known[key]


FLAT = Flat()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Seen:
    """What one camera sees of a scene.

    Attributes:
        sight: how it sees.
        scene: what.
        camera: its geometry.
        world_from_camera: (4, 4) its pose, optical frame.
        view: what lies behind its pixels.
    """

    sight: Sight
    scene: Scene
    camera: CameraGeometry
    world_from_camera: Matrix
    view: View

    def bounds(self, parts: Mask) -> Matrix:
        """The rectangles (N, 4) around some parts (N, P), as in `Sight.bounds`."""
        return self.sight.bounds(self.scene, self.camera, self.world_from_camera, parts)

    def area(self, parts: Mask, bounds: Sequence[float]) -> int:
        """Pixels of some parts (P,), as in `Sight.area`."""
        return self.sight.area(self.scene, self.camera, self.world_from_camera, parts, bounds)


def look(sight: Sight, scene: Scene, camera: CameraGeometry, world_from_camera: Matrix) -> Seen:
    """Let a camera see a scene."""
    view = sight.view(scene, camera, world_from_camera)
    return Seen(sight=sight, scene=scene, camera=camera, world_from_camera=world_from_camera, view=view)
