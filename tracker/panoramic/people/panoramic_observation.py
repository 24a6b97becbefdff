"""Detection of one person in a panorama: near a prediction, or anywhere."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.geometry.small_matrices import mahalanobis2
from peopleboy.tracker.panoramic.people.figure_patch import Map
from peopleboy.tracker.panoramic.people.floor_motion import Floats, FloorMotion
from peopleboy.tracker.panoramic.people.panorama_patches import PanoramaScene
from peopleboy.tracker.panoramic.people.panoramic_config import SightingConfig
from peopleboy.tracker.panoramic.people.place_model import PlaceModel

NEAREST_M = 0.5
_AROUND = np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)], np.float64)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sighting:
    """A detected person.

    Attributes:
        evidence: log-odds that it is a person.
        bearing_rad, distance_m: from the robot.
        place_m: (2,) position in room coordinates.
        error_m2: (2, 2) covariance of the position.
    """

    evidence: float
    bearing_rad: float
    distance_m: float
    place_m: Floats
    error_m2: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Onlooker:
    """Detector with the robot's pose.

    Attributes:
        model: evaluates patches.
        pose: of the robot.
        config: settings.
    """

    model: PlaceModel
    pose: Pose2
    config: SightingConfig

    def expected(self, motion: FloorMotion, scene: PanoramaScene) -> Sighting | None:
        """Detect a person near a prediction; None if there is none."""
        places = motion.place_m[None]
        spread = math.sqrt(float(np.trace(motion.place_m2)) / 2.0)
        if spread > self.config.wide_m:
            places = places + min(spread, self.config.reach_m) * _AROUND
        seen = self.at(scene, np.array([self.polar(place) for place in places]))
        if seen is None:
            return None
        away = seen.place_m - motion.place_m
        is_near = mahalanobis2(away, motion.place_m2 + seen.error_m2) < self.config.gate
        return seen if is_near else None

    def at(self, scene: PanoramaScene, polar: Floats) -> Sighting | None:
        """Search positions (N, 2), bearing and distance, and refine the best; None if there is no person."""
        first = self._best(scene, polar)
        if first is None:
            return None
        seen = self._best(scene, np.array([[first.bearing_rad, first.distance_m]]))
        return None if seen is None or seen.evidence < self.config.least_evidence else seen

    def polar(self, place_m: Floats) -> tuple[float, float]:
        """Return bearing [rad] and distance [m] of a position (2,) in the room."""
        x, y = self.pose.points_to_local(place_m).tolist()
        return math.atan2(y, x), max(math.hypot(x, y), NEAREST_M)

    def _best(self, scene: PanoramaScene, polar: Floats) -> Sighting | None:
        reported = self.model.look(scene.figures.patches(polar[:, 0], polar[:, 1]), polar[:, 1])
        best = int(np.argmax(reported.evidence))
        along, across = reported.offset_m[best].tolist()
        bearing, distance = polar[best].tolist()
        if distance + along < NEAREST_M:
            return None
        bearing, distance = bearing + across / distance, distance + along
        axes = _axes(self.pose.heading + bearing)
        deviation = self.config.error_share * reported.deviation_m[best].astype(np.float64)
        return Sighting(
            evidence=float(reported.evidence[best]),
            bearing_rad=bearing,
            distance_m=distance,
            place_m=self.pose.transform_polar(distance, bearing),
            error_m2=(axes * deviation**2) @ axes.T,
        )


def _axes(angle: float) -> Floats:
    """Return unit vectors away from the robot and to the left, as columns."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, -sine], [sine, cosine]])


# Explanation of the panoramic tracker.


@dataclass(frozen=True, slots=True, eq=False)
class PeopleExplanation:
    """State of the tracker at its newest image.

    Attributes:
        background: (H, W, 3) uint8 RGB, the background model.
        foreground: (H, W) foreground probability.
        covered: (H, W) 1 on tracked people.
    """

    background: NDArray[np.uint8]
    foreground: Map
    covered: Map
