"""Images of the thermal camera a little apart, what moved in them, and who is where."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.run_folder.atomic_output import atomic
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.tracker.camera_mount import Mount, mount_of
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.proposals.motion import change, turned
from peopleboy.tracker.proposals.past_images import EARLIER_S

Floats = NDArray[np.float64]
Grey = NDArray[np.uint8]

APART_S: Final = 0.5
"""Between two images that are kept."""

_LOW: Final = (Posture.SITTING, Posture.BENDING)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PeopleFilm:
    """Images of one run with the truth about them.

    Attributes:
        grey: (N, H, W) images.
        change: (N, H, W) by how much greys changed in 0.2 s beyond what the robot's turn does.
        mount: (3,) row of the horizon [px], focal length [px] and height [m] of the camera.
        image: (P,) int64 in which image a person is, seen or not.
        box: (P, 4) [px] from head to feet.
        visible: (P,) share of the silhouette that is seen.
        inside: (P,) share of it that lies inside the image.
        shown_px: (P,) pixels that are seen.
        is_upright: (P,) whether they stand or walk, not sit or bend.
    """

    grey: Grey
    change: Grey
    mount: Floats
    image: NDArray[np.int64]
    box: Floats
    visible: Floats
    inside: Floats
    shown_px: Floats
    is_upright: NDArray[np.bool_]

    def seen_by(self) -> Mount:
        """Tell how the camera sits."""
        horizon_px, focal_px, height_m = self.mount.tolist()
        return Mount(horizon_px, focal_px, height_m)

    def save(self, path: Path) -> None:
        """Write the film, whole or not at all."""
        arrays = {name: getattr(self, name) for name in self.__dataclass_fields__}
        with atomic(path) as part, part.open("wb") as file:
            np.savez_compressed(file, **arrays)

    @classmethod
    def load(cls, path: Path) -> PeopleFilm:
        """Read a film."""
        with np.load(path, allow_pickle=False) as arrays:
            return cls(**arrays)


def film_upright(scenario: Scenario, seed: int) -> PeopleFilm:
    """Film a scenario with the thermal camera; of the images between those that are kept none is made.

    Raises:
        BadInput: the robot needs eyes to drive.
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
        changes.append(change(before[0], grey, turned(mount, grey.shape, turn_rad)))
        before, begin_s = None, begin_s + APART_S
    return PeopleFilm(
        grey=np.array(greys),
        change=np.array(changes),
        mount=np.array([mount.horizon_px, mount.focal_px, mount.height_m]),
        image=np.array([k for k, _ in people], np.int64),
        box=np.array([person.box for _, person in people], np.float64).reshape(-1, 4),
        visible=np.array([person.visible_fraction for _, person in people], np.float64),
        inside=np.array([person.inside_fraction for _, person in people], np.float64),
        shown_px=np.array([person.visible_px for _, person in people], np.float64),
        is_upright=np.array([person.posture not in _LOW for _, person in people], np.bool_),
    )
