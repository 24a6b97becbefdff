"""Rendered sequences of the thermal camera: sampled images, grey changes, and the people in them."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.people.body.postures import LOW, Posture
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.studies.training.detector.worlds import world_of
from peopleboy.studies.training.samples import Arrays, SampleTask
from peopleboy.tracker.camera_mount import Mount, mount_of
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.sensors.thermal.detector.image_change import (
    EARLIER_S,
    image_difference,
    rotation_homography,
)

Floats = NDArray[np.float64]
Grey = NDArray[np.uint8]

APART_S: Final = 0.5
"""Time between two sampled images."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ThermalSequence(Arrays):
    """Images of one run with ground truth.

    Attributes:
        grey: (N, H, W) images.
        change: (N, H, W) change of grey in 0.2 s, compensated for the robot's rotation.
        mount: (3,) row of the horizon [px], focal length [px] and height [m] of the camera.
        image: (P,) int64 index of the image of each person, visible or not.
        box: (P, 4) [px] from head to feet, as wide as the torso.
        whole: (P, 4) [px] of the whole silhouette.
        posture: (P,) number of the posture, in the order of `Posture`.
        visible: (P,) visible share of the silhouette.
        inside: (P,) share of the silhouette inside the image.
        shown_px: (P,) number of visible pixels.
        is_upright: (P,) whether the person stands or walks.
    """

    grey: Grey
    change: Grey
    mount: Floats
    image: NDArray[np.int64]
    box: Floats
    whole: Floats
    posture: NDArray[np.int64]
    visible: Floats
    inside: Floats
    shown_px: Floats
    is_upright: NDArray[np.bool_]

    def camera_mount(self) -> Mount:
        """Return the mount of the camera."""
        horizon_px, focal_px, height_m = self.mount.tolist()
        return Mount(horizon_px, focal_px, height_m)


def render_thermal(scenario: Scenario, seed: int) -> ThermalSequence:
    """Render a scenario with the thermal camera; only the sampled images are rendered.

    Raises:
        BadInput: the robot needs images to drive.
    """
    rows = scenario.world(seed).robot.cameras[THERMAL].camera.height
    calibration = calibrations_of(scenario.world(seed).robot.cameras).get(THERMAL)
    mount = mount_of(calibration, rows)
    greys: list[Grey] = []
    changes: list[Grey] = []
    people: list[tuple[int, PersonTruth]] = []
    before: tuple[Grey, float] | None = None
    begin_s = 0.0  # when the next pair begins
    for world, observation in blind_drive(scenario, seed):
        if THERMAL not in observation.images:
            continue
        heading = observation.odometry.heading
        if before is None:
            if observation.time_s >= begin_s:
                before, begin_s = (observation.images[THERMAL].copy(), heading), observation.time_s
            continue
        if observation.time_s < begin_s + EARLIER_S - 1e-6:
            continue
        grey = observation.images[THERMAL].copy()
        turn_rad = math.remainder(heading - before[1], math.tau)
        people += [(len(greys), person) for person in world.truth().people if person.box is not None]
        greys.append(grey)
        homography = rotation_homography(mount, grey.shape, turn_rad)
        changes.append(image_difference(before[0], grey, homography))
        before, begin_s = None, begin_s + APART_S
    return ThermalSequence(
        grey=np.array(greys),
        change=np.array(changes),
        mount=np.array([mount.horizon_px, mount.focal_px, mount.height_m]),
        image=np.array([k for k, _ in people], np.int64),
        box=np.array([person.box for _, person in people], np.float64).reshape(-1, 4),
        whole=np.array([person.whole_box for _, person in people], np.float64).reshape(-1, 4),
        posture=np.array([_POSTURES.index(person.posture) for _, person in people], np.int64),
        visible=np.array([person.visible_fraction for _, person in people], np.float64),
        inside=np.array([person.inside_fraction for _, person in people], np.float64),
        shown_px=np.array([person.visible_px for _, person in people], np.float64),
        is_upright=np.array([person.posture not in LOW for _, person in people], np.bool_),
    )


_POSTURES: Final = tuple(Posture)


def render_world(seed: int) -> ThermalSequence:
    """Draw the world of a seed and render it."""
    return render_thermal(parse_scenario(world_of(seed), source=f"world_{seed}", folder=Path()), seed)


def render_task(folder: Path, seed: int) -> SampleTask:
    """Return the task of rendering the world of a seed."""
    return SampleTask(folder / f"world_{seed}.npz", render_world, (seed,))


_LEAST_VISIBLE: Final = 0.35
_LEAST_INSIDE: Final = 0.5
_LEAST_CLEAR: Final = 0.45  # least visible share of the part inside the image, for a good person
_LITTLE_INSIDE: Final = 0.25  # least share of the silhouette inside the image, for a clear person
_CLEAR: Final = 0.7  # least visible share of that part, for a clear person
HIGHEST: Final = 0.25  # largest share of the height above the image
_LEAST_SHOWN_PX: Final = 8.0  # people of fewer visible pixels are ignored


@dataclass(frozen=True, slots=True, eq=False)
class ThermalImage:
    """One image with its people.

    Attributes:
        grey: (H, W) image.
        change: (H, W) change of grey.
        mount: mount of the camera.
        box: (P, 4) [px] boxes of all people who are visible in part: head to feet, as wide as the torso.
        is_good: (P,) whether to train on the person: upright, and not mostly occluded.
        is_clear: (P,) whether the person is upright, and most of the part inside the image is visible.
        whole: (P, 4) [px] boxes of their whole silhouettes.
        posture: (P,) number of the posture, in the order of `Posture`.
        visible: (P,) visible share of the part inside the image.
    """

    grey: Grey
    change: Grey
    mount: Mount
    box: Floats
    is_good: NDArray[np.bool_]
    is_clear: NDArray[np.bool_]
    whole: Floats
    posture: NDArray[np.int64]
    visible: Floats


def load_images(paths: Iterable[Path]) -> list[ThermalImage]:
    """Read the images of all sequences."""
    sequences = map(ThermalSequence.load, paths)
    return [_image(sequence, k) for sequence in sequences for k in range(len(sequence.grey))]


def _image(sequence: ThermalSequence, k: int) -> ThermalImage:
    here = (sequence.image == k) & (sequence.shown_px > _LEAST_SHOWN_PX)
    box = sequence.box[here]
    visible, inside, is_upright = sequence.visible[here], sequence.inside[here], sequence.is_upright[here]
    is_clear = is_upright & (inside > _LITTLE_INSIDE) & (visible > _CLEAR * inside)
    is_good = (
        is_upright
        & (visible > _LEAST_VISIBLE)
        & (inside > _LEAST_INSIDE)
        & (visible > _LEAST_CLEAR * inside)
        & (box[:, 1] > -HIGHEST * box[:, 3])
    )
    return ThermalImage(
        grey=sequence.grey[k],
        change=sequence.change[k],
        mount=sequence.camera_mount(),
        box=box,
        is_good=is_good,
        is_clear=is_clear,
        whole=sequence.whole[here],
        posture=sequence.posture[here],
        visible=visible / np.maximum(inside, 1e-6),
    )
