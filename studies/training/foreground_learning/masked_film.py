"""Films of the panoramic camera that tell which pixels are people."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.run_folder.atomic_output import atomic
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.truth.truth import Truth
from peopleboy.tracker.frame import PANORAMA, Odometry

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MaskedFilm:
    """The images of one run, with the truth about them.

    Attributes:
        images: (N, H, W, 3) uint8 RGB.
        who: (N, H, W) uint8 number of the person seen at each pixel, 0 for none.
        time_s: (N,) of the images [s].
        motion: (N, 3) forward [m], to the left [m] and turn [rad] since the image before, by odometry.
        place_m: (N, P, 2) where people 1, 2, ... stand in the robot's frame [m]; NaN while they are away.
    """

    images: NDArray[np.uint8]
    who: NDArray[np.uint8]
    time_s: Floats
    motion: Floats
    place_m: Floats

    @property
    def is_driven(self) -> bool:
        """Whether the robot moves by more than its wheels' noise."""
        return bool(np.abs(self.motion).sum() > 0.05)

    def odometry(self, k: int) -> Odometry | None:
        """Tell how the robot moved before image k; None for the first."""
        if k == 0:
            return None
        advance, aside, turn = self.motion[k].tolist()
        return Odometry(advance_m=advance, aside_m=aside, turn_rad=turn)

    def save(self, path: Path) -> None:
        """Write the film, whole or not at all."""
        with atomic(path) as part, part.open("wb") as file:
            np.savez(
                file,
                images=self.images,
                who=self.who,
                time_s=self.time_s,
                motion=self.motion,
                place_m=self.place_m,
            )

    @classmethod
    def load(cls, path: Path) -> MaskedFilm:
        """Read a film."""
        with np.load(path, allow_pickle=False) as arrays:
            return cls(**arrays)


def film_people(scenario: Scenario, seed: int) -> MaskedFilm:
    """Film a scenario with the panoramic camera; other cameras' images are never made.

    Raises:
        BadInput: the robot needs eyes to drive.
    """
    scenario = scenario.mounting((PANORAMA,))
    seen: dict[str, list[Any]] = {"images": [], "who": [], "time_s": [], "motion": [], "place_m": []}
    before: Pose2 | None = None
    for world, observation in blind_drive(scenario, seed):
        if PANORAMA in observation.images:
            truth, now = world.truth(PANORAMA), observation.odometry
            seen["images"].append(np.array(observation.images[PANORAMA]))
            seen["who"].append(np.array(truth.instance))
            seen["time_s"].append(observation.time_s)
            seen["motion"].append(_motion(before, now))
            seen["place_m"].append(_places(truth, len(world.config.people)))
            before = now
    return MaskedFilm(**{name: np.array(values) for name, values in seen.items()})


def _motion(before: Pose2 | None, now: Pose2) -> tuple[float, float, float]:
    if before is None:
        return 0.0, 0.0, 0.0
    motion = now.relative_to(before)
    return motion.x, motion.y, motion.heading


def _places(truth: Truth, people: int) -> Floats:
    places = np.full((people, 2), np.nan)
    for person in truth.people:
        places[person.id - 1] = truth.robot.to_local(person.position_m)
    return places
