"""Ground truth of one instant: poses of people, their visibility in the image, and occlusions."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import CameraGeometry, Matrix
from peopleboy.sim.places.moving import Mover

# A box is left, top, width, height [px] in the camera's image, whose pixel (0, 0) spans -0.5..0.5; bounds
# are left, top, right, bottom [px], all NaN if nothing is in front of the camera.

Box = tuple[float, float, float, float]
Edges = Sequence[float]


def box_between(bounds: Edges) -> Box | None:
    """Return the box with these bounds; None if nothing is in front of the camera."""
    left, top, right, bottom = bounds
    return None if math.isnan(left + top) else (left, top, right - left, bottom - top)


def box_of_pixels(first_u: float, last_u: float, first_v: float, last_v: float) -> Box:
    """Return the box that spans whole pixels, first to last column and row included."""
    return (first_u - 0.5, first_v - 0.5, last_u - first_u + 1.0, last_v - first_v + 1.0)


def is_cut_off(bounds: Edges, camera: CameraGeometry) -> bool:
    """Return whether these bounds reach beyond the image's border."""
    left, top, right, bottom = bounds
    return left <= -0.5 or top <= -0.5 or right >= camera.width - 0.5 or bottom >= camera.height - 0.5


NOTHING = -1


@dataclass(frozen=True, slots=True, eq=False)
class Owners:
    """The person, thing or wall at each pixel of an image, computed on demand.

    Attributes:
        names: names of people, things, walls and the robot.
        of_part: (P + 1,) number of the name of each part's owner; the last one for no part.
        part: (H, W) number of the part seen, -1 for none.
    """

    names: tuple[str, ...]
    of_part: NDArray[np.int16]
    part: NDArray[np.int32]

    def image(self) -> NDArray[np.int16]:
        """(H, W) index in `names` of the owner of each pixel, -1 for none."""
        return np.asarray(self.of_part[self.part])

    def mask(self, *names: str) -> NDArray[np.bool_]:
        """Return the (H, W) mask of pixels that show one of these names; unknown names have no pixels."""
        wanted = np.isin(np.array([*self.names, ""]), names)
        return np.asarray(wanted[self.of_part][self.part])


@dataclass(frozen=True, slots=True, kw_only=True)
class ThingTruth:
    """Ground truth of one moving thing at one instant.

    Attributes:
        name: as in the scenario.
        position_m: (x, y, z) of its frame, world frame; z is the height of its foot. For an absent thing,
            the last position, or the one where it will appear.
        heading_rad: [rad] direction of its front.
        is_there: whether it is present.
        is_moving: whether it is being moved.
        moved_by: name of the person who moves it, or moved it last; None for none.
        visible_px: number of pixels that show it.
        visible_box: left, top, width, height [px] of those pixels; None without any.
    """

    name: str
    position_m: tuple[float, float, float]
    heading_rad: float
    is_there: bool
    is_moving: bool
    moved_by: str | None
    visible_px: int
    visible_box: Box | None


def things_truth(movers: Sequence[Mover], time_s: float, owners: Owners) -> tuple[ThingTruth, ...]:
    """Return the truth of all moving things in the view of one camera."""
    if not movers:
        return ()
    image = owners.image()
    return tuple(_thing(mover, time_s, image == owners.names.index(mover.name)) for mover in movers)


def _thing(mover: Mover, time_s: float, seen: NDArray[np.bool_]) -> ThingTruth:
    state = mover.at(time_s)
    return ThingTruth(
        name=mover.name,
        position_m=state.stance.position_m,
        heading_rad=float(np.remainder(state.stance.heading_rad + np.pi, 2.0 * np.pi) - np.pi),
        is_there=state.is_there,
        is_moving=state.is_moving,
        moved_by=state.by,
        visible_px=int(np.count_nonzero(seen)),
        visible_box=_box(seen),
    )


def _box(seen: NDArray[np.bool_]) -> Box | None:
    columns, rows = np.flatnonzero(seen.any(axis=0)), np.flatnonzero(seen.any(axis=1))
    if not len(rows):
        return None
    return box_of_pixels(*(float(edge) for edge in (columns[0], columns[-1], rows[0], rows[-1])))


# People nearer than 3 m or farther than 10 m are not counted (T 3.3).
COUNTED_NEAREST_M = 3.0
COUNTED_FARTHEST_M = 10.0
# In panoramas the lens's rim cuts off nearer people, and a row covers too much depth for farther ones.
ROUND_NEAREST_M = 1.1
ROUND_FARTHEST_M = 7.0

# Name of the occluder for parts that the image border cuts off.
BORDER = "border"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PersonTruth:
    """Ground truth of one person at one instant. Arrays are read-only.

    Boxes are left, top, width, height [px] in the camera's image, whose pixel (0, 0) spans -0.5..0.5.

    Attributes:
        id: 1, 2, ... in the scenario's order.
        name: as in the scenario.
        position_m: (x, y) on the floor, world frame.
        heading_rad: [rad] direction of the body, world frame.
        velocity_m_s: (x, y) [m/s] world frame.
        posture: such as "standing".
        distance_m: [m] on the floor from the camera.
        is_counted: whether the person counts in evaluation at that distance (`is_counted`).
        box: from head to feet, as wide as the torso without arms, ignoring occlusion (T 3.3); None if the
            person is not in front of the camera.
        whole_box: the whole silhouette ignoring occlusion, also outside the image; None as above.
        visible_box: the visible pixels; None when there are none.
        whole_px: pixels of the whole silhouette, including those outside the image, up to one image size
            beyond each border.
        visible_px: number of pixels that show the person.
        visible_fraction: visible_px / whole_px; 0 when whole_px is 0.
        hidden_by: share of the whole silhouette hidden by each thing or person, by name; "border" is the
            share outside the image. With visible_fraction they sum to 1. A pixel counts for the foremost
            occluder. Empty when whole_px is 0, where both sum to 0.
        part_temperature_c: [degC] mean surface temperature by part name.
        joints_m: (17, 3) [m] COCO keypoints, world frame.
        joints_px: (17, 2) [px] u, v of the same; NaN behind the camera.
        joint_is_visible: (17,) whether that pixel shows the person.
    """

    id: int
    name: str
    position_m: tuple[float, float]
    heading_rad: float
    velocity_m_s: tuple[float, float]
    posture: str
    distance_m: float
    is_counted: bool
    box: Box | None
    whole_box: Box | None
    visible_box: Box | None
    whole_px: int
    visible_px: int
    visible_fraction: float
    hidden_by: Mapping[str, float]
    part_temperature_c: Mapping[str, float]
    joints_m: Matrix
    joints_px: Matrix
    joint_is_visible: NDArray[np.bool_]

    def __repr__(self) -> str:
        """Return name, distance and visibility."""
        visible = f"{self.visible_fraction:.0%} visible"
        return f"PersonTruth({self.id} {self.name!r}, {self.distance_m:.1f} m, {visible})"

    @property
    def inside_fraction(self) -> float:
        """Share of the whole silhouette inside the image, ignoring occlusion."""
        return 1.0 - self.hidden_by.get(BORDER, 0.0) if self.whole_px else 0.0

    @property
    def is_in_image(self) -> bool:
        """Whether part of the silhouette is inside the image, ignoring occlusion."""
        return self.inside_fraction > 0.0

    @property
    def occluded_fraction(self) -> float:
        """Share of the silhouette inside the image that is occluded; 1 if the person is outside the image."""
        inside = self.inside_fraction
        return max(0.0, 1.0 - self.visible_fraction / inside) if inside > 0.0 else 1.0

    def hidden_inside(self, other: str) -> float:
        """Share of the silhouette inside the image that is hidden by one person or thing."""
        inside = self.inside_fraction
        return self.hidden_by.get(other, 0.0) / inside if inside > 0.0 else 0.0

    @property
    def occluder(self) -> str | None:
        """The person or thing that hides most of this person, or None; the image border does not count."""
        others = {name: share for name, share in self.hidden_by.items() if name != BORDER}
        return max(others, key=lambda name: others[name]) if others else None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Truth:
    """Ground truth for the instant of one observation. Arrays are read-only.

    Attributes:
        time_s: [s] since the start.
        people: all present people, visible or not.
        instance: (H, W) uint8, the id of the person seen at each pixel, 0 for none.
        body_part: (H, W) uint8, the PART_CLASSES number of the part of a person seen, 0 for none.
        depth_m: (H, W) float32 [m] along the optical axis of the camera, inf for none.
        camera: the camera of boxes and masks, by default the thermal one.
        world_from_camera: (4, 4) pose of its optical frame.
        robot: true pose of the robot.
        robot_velocity: true forward speed [m/s] and turn rate [rad/s].
        contacts: names of the bodies that the robot touches, except the floor.
        things: all moving things of the place, present or not.
        owners: the person, thing or wall at each pixel.
        background_m: renders the (H, W) [m] depth without people and moving things; it costs one rendering.
    """

    time_s: float
    people: tuple[PersonTruth, ...]
    instance: NDArray[np.uint8]
    body_part: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    camera: CameraGeometry
    world_from_camera: Matrix
    robot: Pose2
    robot_velocity: tuple[float, float]
    contacts: tuple[str, ...]
    things: tuple[ThingTruth, ...]
    owners: Owners
    background_m: Callable[[], NDArray[np.float32]]

    def __repr__(self) -> str:
        """List the people."""
        return f"Truth(time_s={self.time_s:.3f}, people: {list(self.people)})"


def counted_m(camera: CameraGeometry) -> tuple[float, float]:
    """Return the range of distances [m] from a camera within which people count in evaluation.

    The range is that of the source (T 3.3). The source has no panoramas; their range is that of
    panoramic trackers.
    """
    if isinstance(camera, Panorama):
        return ROUND_NEAREST_M, ROUND_FARTHEST_M
    return COUNTED_NEAREST_M, COUNTED_FARTHEST_M


def is_counted(distance_m: float, camera: CameraGeometry) -> bool:
    """Return whether a person at this distance from a camera counts in evaluation."""
    nearest_m, farthest_m = counted_m(camera)
    return nearest_m <= distance_m <= farthest_m


# Backgrounds without people and moving things: the reference depth for models of a scene.

Metres = NDArray[np.float32]

_STOOD_M = 1e-3  # a camera that moved or turned by less counts as static
_STOOD_RAD = 1e-3


class Backgrounds:
    """The background of one camera, updated with each truth; it restarts when the camera moves.

    Attributes:
        clean: (H, W) [m] true depth without people and moving things.
        ever: (H, W) [m] farthest true depth so far: the observable part of `clean`.
        frames: number of instants.
    """

    def __init__(self) -> None:
        self.clean: Metres | None = None
        self.ever: Metres | None = None
        self.frames = 0
        self._pose: Matrix | None = None

    def update(self, truth: Truth) -> None:
        """Update with one more instant."""
        if self.ever is None or not self._stands(truth.world_from_camera):
            self._pose = np.array(truth.world_from_camera)
            self.clean, self.ever, self.frames = truth.background_m(), np.array(truth.depth_m), 0
        else:
            self.ever = np.maximum(self.ever, truth.depth_m)
        self.frames += 1

    def _stands(self, pose: Matrix) -> bool:
        assert self._pose is not None
        moved = float(np.abs(pose[:3, 3] - self._pose[:3, 3]).max())
        return moved < _STOOD_M and float(np.abs(pose[:3, :3] - self._pose[:3, :3]).max()) < _STOOD_RAD
