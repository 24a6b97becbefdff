"""The only caller of PyBullet: bodies by name, physics steps, rays, contacts and TinyRenderer's images."""

import weakref
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.bullet_bodies import (
    AT_ORIGIN,
    BulletBodies,
    BulletBody,
    GivenBodies,
    Place,
    SolidBoxes,
    as_unit,
)
from peopleboy.sim.physics.bullet_io import (
    metric_depth,
    projection_matrix,
    quiet,
    shape_arguments,
    view_matrix,
    visual_shape,
)
from peopleboy.sim.physics.physics_engine import Physics
from peopleboy.sim.physics.urdf import MISSING_PHYSICS, find_model
from peopleboy.sim.shapes.bounds import FAR_M, NEAR_M
from peopleboy.sim.shapes.shape_table import VisualShape, as_given
from peopleboy.sim.shapes.shapes import UPRIGHT, Quaternion, Shape, Vector

try:
    with quiet():
        import pybullet
except ImportError as error:
    raise BadInput(MISSING_PHYSICS) from error

GRAVITY_M_S2 = 9.81
_SHAPES_A_BODY = 16  # PyBullet silently drops the rest
_LINK = "link0"  # PyBullet's name for unnamed links
_BASE = -1
_PARKED: Place = ((0.0, 0.0, -500.0), UPRIGHT)
_ALL = -1
_ALL_BUT_STATIC = -3


@dataclass(frozen=True, slots=True)
class Contact:
    """A contact point between two bodies.

    Attributes:
        other: name of the other body.
        position: [m] contact point on the other body, world frame.
        normal: unit vector from the other body to this one, world frame.
        normal_force_n: [N] along that vector; 0 when they touch without pressing.
    """

    other: str
    position: Vector
    normal: Vector
    normal_force_n: float


class _Client:
    """PyBullet's functions, bound to one physics server."""

    def __init__(self) -> None:
        with quiet():
            self._number: int | None = pybullet.connect(pybullet.DIRECT)
        # A world that is dropped without `close` must not keep its server.
        self._end = weakref.finalize(self, pybullet.disconnect, physicsClientId=self._number)

    def __getattr__(self, name: str) -> Callable[..., Any]:
        function = partial(getattr(pybullet, name), physicsClientId=self._number)
        setattr(self, name, function)
        return function

    def close(self) -> None:
        self._end()
        self._number = None

    def __getstate__(self) -> NoReturn:
        """Refuse copies, which would drive the same server."""
        raise BadInput(
            "a world with Bullet cannot be copied or pickled; use physics 'kinematic', or copy before reset()"
        )


class Bullet(Physics):
    """A separate PyBullet world with bodies by name.

    The frame of a link of a URDF is the link's own, not that of its centre of mass. Shapes beyond the 16 that
    a PyBullet body holds go into further bodies under the same name. Several worlds may be open at once.
    """

    def __init__(self, *, physics_hz: int = 240, gravity: bool = True) -> None:
        super().__init__()
        self._client = _Client()
        self._bodies = BulletBodies(self._parts)
        self._poses = np.zeros((0, 4, 4))
        self._hidden = np.zeros(0, np.bool_)
        self._moved: dict[str, BulletBody] = {}
        self._known: dict[str, Matrix] = {}  # poses of bodies of files since they last moved
        self._given = GivenBodies()
        self._visible: dict[str, list[VisualShape]] = {}  # of bodies whose shapes are known without PyBullet
        self._only_seen: set[str] = set()  # visible bodies without collision shapes
        self._unmade: list[tuple[BulletBody, Sequence[Shape]]] = []  # bodies that only TinyRenderer needs
        self._loaded = SolidBoxes(self._client.getAABB)
        self._client.setPhysicsEngineParameter(
            fixedTimeStep=1.0 / physics_hz, deterministicOverlappingPairs=1
        )
        self._client.setGravity(0.0, 0.0, -GRAVITY_M_S2 if gravity else 0.0)

    def close(self) -> None:
        """Free the world; closing twice is harmless."""
        self._client.close()

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
        """See `Physics.add_urdf`; of an SDF file the first model is added."""
        self._bodies.by_name.check_new(name)
        file = find_model(path)
        load = self._load_sdf if file.suffix == ".sdf" else self._load_urdf
        try:
            with quiet():
                number = load(str(file), fixed, scale)
        except pybullet.error as error:
            raise BadInput(f"body {name!r}: PyBullet cannot load {file} ({error})") from error
        self._register(name, number, moves_by_itself=not fixed)
        self.set_pose(name, position, orientation)

    def set_pose(self, name: str, position: Vector, orientation: Quaternion) -> None:
        """See `Physics.set_pose`."""
        body = self._bodies[name]
        if body.hidden_at is not None:
            body.hidden_at = (position, orientation)
            self._known.pop(name, None)
        else:
            self._put(body, (position, orientation))

    def set_poses(self, names: Sequence[str], positions: ArrayLike, orientations: ArrayLike) -> None:
        """See `Physics.set_poses`."""
        if self._only_seen.issuperset(names):
            self._given.put_all(names, positions, orientations)
            return
        rows = np.asarray(positions, np.float64).tolist(), np.asarray(orientations, np.float64).tolist()
        for name, position, orientation in zip(names, *rows, strict=True):
            self.set_pose(name, position, orientation)

    def shift(self, name: str, offset_m: Vector) -> None:
        """See `Physics.shift`."""
        body = self._bodies[name]
        position, orientation = self._base_place(body)
        velocity = self._client.getBaseVelocity(body.ids[0])
        to = position[0] + offset_m[0], position[1] + offset_m[1], position[2] + offset_m[2]
        self._put(body, (to, orientation))
        self._client.resetBaseVelocity(body.ids[0], *velocity)  # PyBullet stops a body that is put elsewhere

    def set_hidden(self, name: str, hidden: bool) -> None:
        """See `Physics.set_hidden`."""
        body = self._bodies[name]
        if body.moves_by_itself:
            raise BadInput(f"body {name!r} is not fixed: it cannot be hidden")
        if hidden and body.hidden_at is None:
            place = self._base_place(body)
            self._put(body, _PARKED)
            body.hidden_at = place
        elif not hidden and body.hidden_at is not None:
            self._put(body, body.hidden_at)
            body.hidden_at = None
        self._hidden[body.parts.start : body.parts.stop] = hidden
        if body.is_given and not body.solid_links:
            (self._only_seen.discard if hidden else self._only_seen.add)(name)

    def hidden_parts(self) -> NDArray[np.bool_]:
        """Return (P,) whether a part is hidden."""
        return self._hidden.copy()

    def step(self) -> None:
        """See `Physics.step`."""
        self._client.stepSimulation()
        for body in self._bodies.moving:
            self._note_move(body)

    def set_joint_speeds(self, name: str, speeds: Mapping[str, float], max_torque_nm: float) -> None:
        """See `Physics.set_joint_speeds`; [m/s], [N] for sliding joints. Without torque joints run free."""
        body = self._bodies[name]
        self._client.setJointMotorControlArray(
            body.ids[0],
            body.links_of(list(speeds)),
            pybullet.VELOCITY_CONTROL,
            targetVelocities=list(speeds.values()),
            forces=[max_torque_nm] * len(speeds),
        )

    def joint_states(self, name: str, joints: Sequence[str]) -> tuple[Matrix, Matrix]:
        """See `Physics.joint_states`; [m] and [m/s] for sliding joints."""
        body = self._bodies[name]
        states = self._client.getJointStates(body.ids[0], body.links_of(joints))
        return np.array([state[0] for state in states]), np.array([state[1] for state in states])

    def velocity(self, name: str) -> tuple[Matrix, Matrix]:
        """Return velocity (3,) [m/s] of the base's centre of mass, and angular (3,) [rad/s], world frame."""
        linear, angular = self._client.getBaseVelocity(self._bodies[name].ids[0])
        return np.array(linear), np.array(angular)

    def pose(self, name: str) -> Matrix:
        """See `Physics.pose`."""
        body = self._bodies[name]
        if body.is_given:
            return pose_matrices(*(body.hidden_at or self._base_place(body)))
        if name not in self._known:
            self._known[name] = pose_matrices(*(body.hidden_at or self._base_place(body)))
        return self._known[name].copy()

    def part_poses(self) -> Matrix:
        """See `Physics.part_poses`."""
        moved = list(self._moved.values())
        if moved:
            places = []
            for body in moved:
                places.append(self._base_place(body))
                if len(body.parts) > 1:
                    places += self._link_places(body)
            numbers = [part for body in moved for part in body.parts]
            self._poses[numbers] = pose_matrices(*zip(*places, strict=True))
            self._moved.clear()
        parts, poses = self._given.moved_poses()
        self._poses[parts] = poses
        return self._poses.copy()

    def visual_shapes(self) -> list[VisualShape]:
        """Return all visible shapes by part; those of files are read back from PyBullet."""
        return [shape for body in self._bodies for shape in self._visible_shapes(body)]

    def cast_rays(
        self, from_m: ArrayLike, to_m: ArrayLike, ignore: str | None = None
    ) -> tuple[Matrix, NDArray[np.int64]]:
        """See `Physics.cast_rays`.

        Hits on given shapes are exact. Hits on files are PyBullet's, which intersects round shapes
        iteratively: mostly within 1 mm, and within 2 cm for grazing rays.
        """
        starts, ends = np.asarray(from_m, np.float64), np.asarray(to_m, np.float64)
        fraction, part = self._given.cast_rays(starts, ends, ignore)
        near = self._loaded.find_near(starts, ends, ignore)
        if len(near):
            mask = _ALL if ignore is None else ~self._group_of(self._bodies[ignore])
            hits = self._client.rayTestBatch(
                starts[near].tolist(), ends[near].tolist(), numThreads=1, collisionFilterMask=mask
            )
            for ray, (number, link, met_at, *_) in zip(near.tolist(), hits, strict=True):
                if met_at < fraction[ray]:
                    fraction[ray], part[ray] = met_at, self._bodies.part_of(number, link)
        return fraction, part

    def contacts(self, name: str) -> list[Contact]:
        """Return the contacts of a body with others during the last step."""
        rows = [row for id_ in self._bodies[name].ids for row in self._client.getContactPoints(bodyA=id_)]
        contacts = [Contact(self._bodies.name_of(row[2]), row[6], row[7], row[9]) for row in rows]
        return [contact for contact in contacts if contact.other != name]

    def touching(self, name: str) -> set[str]:
        """See `Physics.touching`."""
        rows = [row for id_ in self._bodies[name].ids for row in self._client.getContactPoints(bodyA=id_)]
        return {self._bodies.name_of(number) for number in {row[2] for row in rows}} - {name}

    def camera_image(
        self, camera: Pinhole, world_from_camera: Matrix, only: Collection[str] | None = None
    ) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Draw the world, or only the bodies of some names, with TinyRenderer, without shadows.

        TinyRenderer replaces spheres and capsules by polyhedra of 42 corners and an infinite plane by a large
        square, so that the outline of a large round thing lies up to 5 % of its radius inside the true one.

        Returns:
            part: (H, W) number of the part seen at each pixel centre, -1 where none.
            depth: (H, W) [m] along the optical axis, inf where none.
        """
        self._show_all()
        absent = [body for body in self._bodies if only is not None and body.name not in only]
        self._set_opacity(absent, 0.0)
        image = self._client.getCameraImage(
            camera.width,
            camera.height,
            view_matrix(world_from_camera),
            projection_matrix(camera, NEAR_M, FAR_M),
            shadow=0,
            flags=pybullet.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX,
            renderer=pybullet.ER_TINY_RENDERER,
        )
        self._set_opacity(absent, 1.0)
        shape = (camera.height, camera.width)
        part = self._bodies.parts_of(np.reshape(image[4], shape))
        depth = metric_depth(np.reshape(image[3], shape), NEAR_M, FAR_M)
        return part, np.where(part >= 0, depth, np.inf).astype(np.float32)

    def _check_new(self, name: str) -> None:
        self._bodies.by_name.check_new(name)

    def _add_shapes(self, name: str, shapes: Sequence[Shape], visible: bool, solid: bool) -> None:
        part = len(self._parts)
        body = BulletBody(name=name, parts=range(part, part + 1), is_given=True)
        if solid:
            self._make(body, shapes, visible=visible, solid=True)
        else:
            self._only_seen.add(name)
        if visible and not solid:
            self._unmade.append((body, shapes))
        self._add(body, [_LINK])
        self._given.add(name, part, shapes if solid else ())
        self._visible[name] = [as_given(shape, part) for shape in shapes] if visible else []

    def _show_all(self) -> None:
        """Update all visible bodies in PyBullet, including those without collision shapes."""
        for body, shapes in self._unmade:
            self._make(body, shapes, visible=True, solid=False)
            self._bodies.know_ids(body)
        self._unmade.clear()
        for body in self._bodies:
            if body.ids and not body.moves_by_itself and not body.solid_links:
                self._tell(body, self._base_place(body))

    def _make(self, body: BulletBody, shapes: Sequence[Shape], *, visible: bool, solid: bool) -> None:
        """Create a body of given shapes in PyBullet."""
        starts = range(0, len(shapes), _SHAPES_A_BODY)
        try:
            with quiet():
                body.ids = tuple(
                    self._create(shapes[at : at + _SHAPES_A_BODY], visible, solid) for at in starts
                )
        except pybullet.error as error:
            raise BadInput(f"body {body.name!r}: PyBullet refuses its shapes ({error})") from error
        links = [(number, _BASE) for number in body.ids]
        body.visible_links, body.solid_links = links if visible else [], links if solid else []

    def _create(self, shapes: Sequence[Shape], visible: bool, solid: bool) -> int:
        """Make one PyBullet body."""
        # A body without visual shapes is drawn by its collision shapes: transparency prevents it.
        colours = [[1.0, 1.0, 1.0, float(visible)]] * len(shapes)
        visual = self._client.createVisualShapeArray(**shape_arguments(shapes, "visual"), rgbaColors=colours)
        collision = -1
        if solid:
            collision = self._client.createCollisionShapeArray(**shape_arguments(shapes, "collision"))
        number: int = self._client.createMultiBody(0.0, collision, visual)
        return number

    def _load_urdf(self, file: str, fixed: bool, scale: float) -> int:
        # Without these, cylinders collide as prisms, on which no wheel runs true, and inertia is guessed.
        flags = pybullet.URDF_USE_IMPLICIT_CYLINDER | pybullet.URDF_USE_INERTIA_FROM_FILE
        number: int = self._client.loadURDF(file, useFixedBase=fixed, globalScaling=scale, flags=flags)
        return number

    def _load_sdf(self, file: str, fixed: bool, scale: float) -> int:
        number: int
        number, *others = self._client.loadSDF(file, globalScaling=scale)
        for other in others:
            self._client.removeBody(other)
        if fixed:
            self._client.changeDynamics(number, -1, mass=0.0)
        return number

    def _register(self, name: str, number: int, *, moves_by_itself: bool) -> None:
        """Register a body that PyBullet has read from a file."""
        joints = [
            self._client.getJointInfo(number, link) for link in range(self._client.getNumJoints(number))
        ]
        links = [(number, link) for link in range(_BASE, len(joints))]
        names = [self._client.getBodyInfo(number)[0].decode(), *(joint[12].decode() for joint in joints)]
        first = len(self._parts)
        body = BulletBody(
            name=name,
            ids=(number,),
            parts=range(first, first + len(names)),
            joints={joint[1].decode(): joint[0] for joint in joints},
            base_from_inertia=self._client.getDynamicsInfo(number, _BASE)[3:5],
            moves_by_itself=moves_by_itself,
            visible_links=[(row[0], row[1]) for row in self._visual_rows(number)],
            solid_links=[link for link in links if self._client.getCollisionShapeData(*link)],
        )
        self._add(body, names)
        self._loaded.add(name, body.solid_links)

    def _add(self, body: BulletBody, link_names: Sequence[str]) -> None:
        self._bodies.add(body, link_names)
        self._poses = np.concatenate([self._poses, np.zeros((len(link_names), 4, 4))])
        self._hidden = np.append(self._hidden, np.zeros(len(link_names), np.bool_))

    def _put(self, body: BulletBody, base: Place) -> None:
        if body.is_given:
            self._given.put(body.name, *base)
        else:
            body.put_at = None if body.moves_by_itself else (base[0], as_unit(base[1]))
            self._note_move(body)
        if body.solid_links or not body.is_given:
            self._tell(body, base)

    def _tell(self, body: BulletBody, place: Place) -> None:
        """Set the pose of a body's base in PyBullet."""
        if body.base_from_inertia != AT_ORIGIN:
            place = pybullet.multiplyTransforms(*place, *body.base_from_inertia)
        for number in body.ids:
            self._client.resetBasePositionAndOrientation(number, *place)

    def _note_move(self, body: BulletBody) -> None:
        """Update a body from a file."""
        self._moved[body.name] = body
        self._known.pop(body.name, None)
        self._loaded.forget(body.name)

    def _base_place(self, body: BulletBody) -> Place:
        if body.is_given:
            return self._given.place(body.name)
        if body.put_at is not None:
            return body.put_at
        place: Place = self._client.getBasePositionAndOrientation(body.ids[0])
        if body.base_from_inertia != AT_ORIGIN:
            place = pybullet.multiplyTransforms(*place, *pybullet.invertTransform(*body.base_from_inertia))
        return place

    def _link_places(self, body: BulletBody) -> list[Place]:
        links = range(len(body.parts) - 1)
        states = self._client.getLinkStates(body.ids[0], links, computeForwardKinematics=1)
        return [state[4:6] for state in states]

    def _visible_shapes(self, body: BulletBody) -> list[VisualShape]:
        if body.is_given:
            return self._visible[body.name]
        rows = self._visual_rows(body.ids[0])
        return [visual_shape(row, self._bodies.part_of(row[0], row[1])) for row in rows]

    def _visual_rows(self, number: int) -> list[Sequence[Any]]:
        """Return PyBullet's data of all shapes of one of its bodies that are not transparent."""
        return [row for row in self._client.getVisualShapeData(number) if row[7][3] > 0.0]

    def _set_opacity(self, bodies: Sequence[BulletBody], alpha: float) -> None:
        for body in bodies:
            for number, link in body.visible_links:
                self._client.changeVisualShape(number, link, rgbaColor=[1.0, 1.0, 1.0, alpha])

    def _group_of(self, body: BulletBody) -> int:
        """Return the collision group of a single body, which rays can ignore."""
        if body.group is None:
            body.group = self._bodies.new_group()
            mask = _ALL if body.moves_by_itself else _ALL_BUT_STATIC
            links = range(-1, len(body.parts) - 1)
            for number, link in [(number, link) for number in body.ids for link in links]:
                self._client.setCollisionFilterGroupMask(number, link, body.group, mask)
        return body.group
