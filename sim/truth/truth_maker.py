"""Makes ground truth from rendered views and the people's bodies."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final, NamedTuple, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.sim.geometry.pinhole import Matrix, invert_pose, transform
from peopleboy.sim.people.body.body_shapes import TORSO_PARTS
from peopleboy.sim.people.body_model import ARM_PARTS, PART_CLASSES
from peopleboy.sim.people.crowd import Crowd
from peopleboy.sim.physics.solid_shapes import PartKey
from peopleboy.sim.places.moving import Mover
from peopleboy.sim.rendering.renderer import RenderPass
from peopleboy.sim.rendering.view import Cover
from peopleboy.sim.shapes.materials import Material
from peopleboy.sim.truth.truth import (
    BORDER,
    NOTHING,
    Box,
    Edges,
    Owners,
    PersonTruth,
    Truth,
    box_between,
    box_of_pixels,
    is_counted,
    is_cut_off,
    things_truth,
)

A = TypeVar("A", bound=NDArray[Any])
Depth = NDArray[np.float32]
Bytes = NDArray[np.uint8]

_WHOLE: Final = 0  # index of the silhouette among a person's outlines


class TruthMaker:
    """Maps parts to their owners, and makes the truth of each instant."""

    def __init__(
        self,
        keys: Sequence[PartKey],
        crowd: Crowd,
        materials: Sequence[Material],
        movers: Sequence[Mover],
    ) -> None:
        self._people = crowd.people
        owners = [key.name.split("/")[0] for key in keys]
        names = [person.name for person in self._people]
        self._owner_names = names + sorted(set(owners) - set(names))
        number = {name: k for k, name in enumerate(self._owner_names)}
        self._owner_of_part = np.array([number[owner] for owner in owners], np.int64)
        self._owner_or_nothing = np.array([*self._owner_of_part, NOTHING], np.int16)
        self._movers = movers
        self._is_moved = np.isin(owners, [mover.name for mover in movers])
        self.person_of_part = np.where(self._owner_of_part < len(names), self._owner_of_part, -1)
        parts = [key.name.split("/")[-1] for key in keys]
        is_person = self.person_of_part >= 0
        classes = [PART_CLASSES.get(p, 0) if own else 0 for p, own in zip(parts, is_person, strict=True)]
        # The last entry is for part -1, where there is no surface.
        self._class_of_part = np.array([*classes, 0], np.uint8)
        self._id_of_part = np.array([*(self.person_of_part + 1), 0], np.uint8)
        self._outlines = _outlines(parts, self.person_of_part, len(names))
        self._temperatures = [
            {parts[p]: materials[p].temperature_c for p in np.flatnonzero(whole).tolist()}
            for whole, *_ in self._outlines
        ]

    def make(
        self,
        *,
        time_s: float,
        seen: RenderPass,
        robot: Pose2,
        robot_velocity: tuple[float, float],
        contacts: tuple[str, ...],
    ) -> Truth:
        """Make the truth of an instant for one camera."""
        view, people, owners = seen.view, len(self._people), len(self._owner_names)
        cover = seen.renderer.cover(view, self._owner_of_part, people, owners)
        whose = Owners(tuple(self._owner_names), self._owner_or_nothing, view.part)
        instance, body_part = _looked_up(view.part, self._id_of_part, self._class_of_part)
        return Truth(
            time_s=time_s,
            people=self._everybody(cover, seen),
            instance=_frozen(instance),
            body_part=_frozen(body_part),
            depth_m=_frozen(view.depth),
            camera=seen.camera,
            world_from_camera=_frozen(seen.world_from_camera),
            robot=robot,
            robot_velocity=robot_velocity,
            contacts=contacts,
            things=things_truth(self._movers, time_s, whose),
            owners=whose,
            background_m=partial(self._background, seen),
        )

    def _background(self, seen: RenderPass) -> Depth:
        """Render a camera's view without people and moving things."""
        hidden = seen.scene.hidden | self._is_moved | (self.person_of_part >= 0)
        bare = replace(seen.scene, renderer="raycast", hidden=hidden)
        return seen.renderer.view(bare, seen.camera, seen.world_from_camera).depth

    def box(self, person: int, seen: RenderPass) -> Box | None:
        """Return the truth box of one person alone, by its number from 1; None as in `PersonTruth`."""
        k = person - 1
        if not self._people[k].present:
            return None
        height, torso = seen.bounds(self._outlines[k, _WHOLE + 1 :]).tolist()
        return _thesis_box(height, torso)

    def _everybody(self, cover: Cover, seen: RenderPass) -> tuple[PersonTruth, ...]:
        here = [k for k, person in enumerate(self._people) if person.present]
        if not here:
            return ()
        bounds = seen.bounds(self._outlines[here].reshape(3 * len(here), -1)).reshape(-1, 3, 4).tolist()
        shown, visible = cover.seen[here].tolist(), cover.bounds[here].tolist()
        people = zip(here, shown, visible, bounds, self._joints(here, seen), strict=True)
        return tuple(self._person(seen, *one) for one in people)

    def _person(
        self,
        seen: RenderPass,
        k: int,
        shown: list[int],
        pixels: Edges,
        edges: Sequence[Edges],
        joints: "_Joints",
    ) -> PersonTruth:
        """Return a person's truth from the pixels of each owner on its silhouette, and its own pixels."""
        person, (whole, height, torso) = self._people[k], edges
        (x, y), (u, v) = person.position.tolist(), person.velocity.tolist()
        camera_x, camera_y = seen.world_from_camera[:2, 3].tolist()
        distance = float(np.hypot(x - camera_x, y - camera_y))
        visible, area = shown[k], self._whole_area(k, sum(shown), seen, whole)
        return PersonTruth(
            id=k + 1,
            name=person.name,
            position_m=(x, y),
            heading_rad=float(person.heading),
            velocity_m_s=(u, v),
            posture=str(person.posture),
            distance_m=distance,
            is_counted=is_counted(distance, seen.camera),
            box=_thesis_box(height, torso),
            whole_box=box_between(whole),
            visible_box=box_of_pixels(*pixels) if visible else None,
            whole_px=area,
            visible_px=visible,
            visible_fraction=visible / area if area else 0.0,
            hidden_by=self._hidden_by(k, shown, area),
            part_temperature_c=self._temperatures[k],
            joints_m=_frozen(joints.place_m),
            joints_px=_frozen(joints.pixel),
            joint_is_visible=_frozen(joints.is_visible),
        )

    def _whole_area(self, k: int, inside: int, seen: RenderPass, whole: Edges) -> int:
        """Return the pixels of the whole silhouette; counts those outside the image only if there are any."""
        if not is_cut_off(whole, seen.camera):
            return inside
        # TinyRenderer's silhouettes may be a few pixels larger.
        return max(inside, seen.area(self._outlines[k, _WHOLE], whole))

    def _hidden_by(self, k: int, shown: list[int], area: int) -> dict[str, float]:
        """Return the share of the whole silhouette that each other owner, or the border, hides."""
        if not area:
            return {}
        shares = {
            self._owner_names[owner]: pixels / area
            for owner, pixels in enumerate(shown)
            if pixels and owner != k
        }
        outside = area - sum(shown)
        return shares | {BORDER: outside / area} if outside > 0 else shares

    def _joints(self, here: Sequence[int], seen: RenderPass) -> "Iterator[_Joints]":
        """Return the joints of some people, by their numbers from 0."""
        places = np.concatenate([self._people[k].joints() for k in here])
        pixels = seen.camera.project(transform(invert_pose(seen.world_from_camera), places))
        size = np.array([seen.camera.width, seen.camera.height])
        is_inside = np.all((pixels > -0.5) & (pixels < size - 0.5), axis=1)
        u, v = np.rint(pixels[is_inside]).astype(np.int64).T
        ids = np.repeat(np.array(here) + 1, len(places) // len(here))
        is_visible = np.zeros(len(places), np.bool_)
        is_visible[is_inside] = self._id_of_part[seen.view.part[v, u]] == ids[is_inside]
        shape = len(here), -1
        return map(_Joints, places.reshape(*shape, 3), pixels.reshape(*shape, 2), is_visible.reshape(shape))


class _Joints(NamedTuple):
    """A person's joints: positions (17, 3) [m], pixels (17, 2), and whether each is visible (17,)."""

    place_m: Matrix
    pixel: Matrix
    is_visible: NDArray[np.bool_]


def _outlines(parts: Sequence[str], person_of_part: NDArray[np.int64], people: int) -> NDArray[np.bool_]:
    """Return the parts of each person that define its boxes' edges, (N, 3, P): whole, height, torso."""
    is_arm, is_torso, is_body = (
        np.isin(parts, names) for names in (ARM_PARTS, TORSO_PARTS, list(PART_CLASSES))
    )
    whole = (person_of_part == np.arange(people)[:, None]) & is_body
    return np.stack([whole, whole & ~is_arm, whole & is_torso], axis=1)


@njit(cache=True, nogil=True)
def _looked_up(part: NDArray[np.int32], one: Bytes, other: Bytes) -> tuple[Bytes, Bytes]:
    """Look up the part of each pixel (H, W) in two tables (P + 1,), whose last entry is for part -1."""
    first, second = np.empty(part.shape, np.uint8), np.empty(part.shape, np.uint8)
    nothing = np.uint64(len(one) - 1)
    for v in range(np.uint64(part.shape[0])):
        for u in range(np.uint64(part.shape[1])):
            row = np.uint64(part[v, u]) if part[v, u] >= 0 else nothing
            first[v, u], second[v, u] = one[row], other[row]
    return first, second


def _thesis_box(height: Edges, torso: Edges) -> Box | None:
    """Return the box from head to feet, with the torso's width without arms (T 3.3), from the edges."""
    return box_between((torso[0], height[1], torso[2], height[3]))


def _frozen(array: A) -> A:
    """Return a view of an array that cannot be written to."""
    view = array.view()
    view.setflags(write=False)
    return view
