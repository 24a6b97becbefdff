"""Several people tracked all round a robot that stands or drives."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.frame import Calibration, Frame, Odometry
from peopleboy.tracker.panorama_calibration import PanoramaCalibration
from peopleboy.tracker.panoramic.foreground.foreground import Foreground
from peopleboy.tracker.panoramic.panorama_view import PanoramaView, view_of
from peopleboy.tracker.panoramic.people.floor_motion import Motion
from peopleboy.tracker.panoramic.people.identity import Register
from peopleboy.tracker.panoramic.people.panoramic_config import PeopleConfig
from peopleboy.tracker.panoramic.people.panoramic_person import PanoramicPerson
from peopleboy.tracker.panoramic.people.people_explanation import PeopleExplanation
from peopleboy.tracker.panoramic.people.place_file import COMMAND
from peopleboy.tracker.panoramic.people.place_model import PlaceModel
from peopleboy.tracker.panoramic.people.scene import Scene, person_box
from peopleboy.tracker.panoramic.people.search import promising_places
from peopleboy.tracker.panoramic.people.sighting import Onlooker, Sighting
from peopleboy.tracker.panoramic.robot_pose import RobotPose
from peopleboy.tracker.track import FloorPlace, Status, Track

PANORAMA = "panorama"
LONGEST_STEP_S = 2.0


class PanoramicTracker:
    """Tracks people on the floor by what a learned model sees in the panorama.

    People are looked for from the nearest to the farthest, and whoever is found is taken out of the picture
    for those behind.

    Args:
        model: reads what the panorama shows at a place.
        view: of the camera that the model holds for.
        config: settings.
    """

    def __init__(self, model: PlaceModel, view: PanoramaView, config: PeopleConfig | None = None) -> None:
        self.config = PeopleConfig() if config is None else config
        self._model, self._view = model, view
        self._foreground = Foreground()
        self._register = Register(self.config.identity)
        self._pose = RobotPose()
        self._camera: PanoramaCalibration | None = None
        self._seen_from: RobotPose | None = None
        self._time_s = -math.inf
        self._persons: tuple[PanoramicPerson, ...] = ()
        self._scene: Scene | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The panoramic camera."""
        return (PANORAMA,)

    @property
    def explanation(self) -> PeopleExplanation | None:
        """What it took for people in the newest image; None before the first."""
        if self._scene is None:
            return None
        return PeopleExplanation(self._foreground.background, self._scene.foreground, self._scene.covered)

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse another camera than the model was trained on, before there are images.

        Raises:
            BadInput: it is another, or none that sees all round.
        """
        self._checked(calibrations)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is where.

        Raises:
            BadInput: an image that is none, or of another camera than the model was trained on.
        """
        if frame.odometry is not None:
            self._pose = self._pose.moved(frame.odometry)
        if PANORAMA in frame.images:
            self._look(frame)
        return tuple(self._track(person, frame) for person in self._persons if person.id)

    def _look(self, frame: Frame) -> None:
        """Take in a new panorama."""
        image, calibration = frame.rgb(PANORAMA), self._checked(frame.calibrations)
        moved = None if self._seen_from is None else _between(self._seen_from, self._pose)
        foreground = self._foreground.update(image, frame.time_s, moved, calibration)
        dt_s = min(frame.time_s - self._time_s, LONGEST_STEP_S)
        self._seen_from, self._time_s = self._pose, frame.time_s
        self._scene = scene = Scene.of(image, foreground, self._foreground.novelty, calibration)
        looker = Onlooker(self._model, self._pose, self.config.sighting)
        known = self._followed(scene, looker, dt_s)
        known = self._with_newcomers(known, scene, looker)
        self._persons = self._named(self._kept(known))

    def _checked(self, calibrations: Mapping[str, Calibration]) -> PanoramaCalibration:
        """Give the camera's calibration, if it is one that the model was trained on."""
        camera = calibrations.get(PANORAMA)
        if camera is self._camera and self._camera is not None:
            return self._camera
        if not isinstance(camera, PanoramaCalibration):
            raise BadInput(f"camera {PANORAMA!r}: the tracker wants a calibrated one that sees all round")
        if why := self._view.refusal(view_of(camera, camera.width, camera.height)):
            raise BadInput(f"{why}; `{COMMAND}` and `peopleboy train-foreground` learn for another")
        self._camera = camera
        return camera

    def _followed(self, scene: Scene, looker: Onlooker, dt_s: float) -> list[PanoramicPerson]:
        """Look for everybody who is known, the nearest first."""
        config = self.config
        expected = (
            replace(person, motion=person.motion.later(dt_s, config.restlessness)) for person in self._persons
        )
        found: list[PanoramicPerson] = []
        for person in sorted(expected, key=lambda one: looker.polar(one.motion.place_m)[1]):
            bearing, distance = looker.polar(person.motion.place_m)
            hidden = scene.hidden_share(bearing, distance)
            seen = looker.expected(person.motion, scene) if hidden < config.sighting.blind_share else None
            hider = _hider(bearing, found, looker) if hidden > config.sighting.partly_share else None
            if seen is None:
                is_hidden = hidden > config.sighting.hidden_share
                found.append(self._unseen(person, dt_s, hider if is_hidden else None))
            else:
                found.append(self._seen(person, seen, scene, hider))
        return found

    def _unseen(self, person: PanoramicPerson, dt_s: float, hider: int | None) -> PanoramicPerson:
        """Take in that a person is not seen; who is hidden is trusted as before."""
        return replace(
            person,
            motion=person.motion.slowed(dt_s, self.config.fading_s),
            trust=person.trust
            if hider is not None
            else self._trusted(person.trust, self.config.life.miss, dt_s),
            status=Status.TOTALLY_OCCLUDED,
            occluder=hider,
            strange_s=0.0,
        )

    def _trusted(self, trust: float, evidence: float, dt_s: float) -> float:
        """Let the log odds of a new image join those before."""
        life = self.config.life
        newest = min(evidence, life.most_trust)
        return trust + (1.0 - math.exp(-dt_s / life.trust_s)) * (newest - trust)

    def _seen(
        self, person: PanoramicPerson, seen: Sighting, scene: Scene, hider: int | None
    ) -> PanoramicPerson:
        """Take in that a person is seen."""
        looks, is_whole = scene.looks(seen.bearing_rad, seen.distance_m), hider is None
        passed_s = self._time_s - person.seen_s
        scene.cover(seen.bearing_rad, seen.distance_m)
        is_strange = is_whole and person.looks.unlikeness(looks) > self.config.identity.strange
        return replace(
            person,
            motion=person.motion.corrected(seen.place_m, seen.error_m2),
            lasting_m2=self.config.lasting_share**2 * seen.error_m2,
            seen_s=self._time_s,
            sightings=person.sightings + 1,
            trust=self._trusted(person.trust, seen.evidence, passed_s),
            status=Status.TRACKED if is_whole else Status.PARTLY_OCCLUDED,
            looks=person.looks if is_strange or not is_whole else person.looks.joined(looks),
            newest=looks,
            strange_s=person.strange_s + passed_s if is_strange else 0.0,
            occluder=hider,
        )

    def _with_newcomers(
        self, known: list[PanoramicPerson], scene: Scene, looker: Onlooker
    ) -> list[PanoramicPerson]:
        """Look where nobody is known; who is found is somebody who was out of sight, or new."""
        life = self.config.life
        everybody = list(known)
        for polar in promising_places(scene.figures, life.newcomers):
            seen = looker.at(scene, polar[None])
            if seen is None or seen.distance_m > life.farthest_m:
                continue
            if any(one.is_seen and _way(one, seen) < life.apart_m for one in everybody):
                continue
            lost = self._lost(everybody, seen, scene)
            if lost is None:
                everybody.append(self._newcomer(seen, scene))
            else:
                motion = Motion.begin(seen.place_m, seen.error_m2)
                everybody[everybody.index(lost)] = self._seen(replace(lost, motion=motion), seen, scene, None)
        return everybody

    def _lost(
        self, persons: Sequence[PanoramicPerson], seen: Sighting, scene: Scene
    ) -> PanoramicPerson | None:
        """Find who is out of sight, may have come here, and looks like who is seen here."""
        looks, identity = scene.looks(seen.bearing_rad, seen.distance_m), self.config.identity
        near = [
            one
            for one in persons
            if not one.is_seen
            and _way(one, seen) < identity.reach_m + identity.fastest_m_s * (self._time_s - one.seen_s)
            and one.looks.unlikeness(looks) < identity.alike
        ]
        return min(near, key=lambda one: _way(one, seen), default=None)

    def _newcomer(self, seen: Sighting, scene: Scene) -> PanoramicPerson:
        looks = scene.looks(seen.bearing_rad, seen.distance_m)
        scene.cover(seen.bearing_rad, seen.distance_m)
        return PanoramicPerson(
            id=0,
            motion=Motion.begin(seen.place_m, seen.error_m2),
            lasting_m2=self.config.lasting_share**2 * seen.error_m2,
            born_s=self._time_s,
            seen_s=self._time_s,
            sightings=1,
            trust=min(seen.evidence, self.config.life.most_trust),
            status=Status.TENTATIVE,
            looks=looks,
            newest=looks,
        )

    def _kept(self, persons: Sequence[PanoramicPerson]) -> list[PanoramicPerson]:
        """Let go of those who are gone, and of doubles: of two at one place, who was seen last stays."""
        kept: list[PanoramicPerson] = []
        gone: list[PanoramicPerson] = []
        for person in sorted(persons, key=lambda one: (-one.seen_s, one.id == 0, one.id)):
            is_double = any(_apart(person, other) < self.config.life.double_m for other in kept)
            is_gone = (
                self._time_s - person.seen_s > self._patience_s(person)
                or person.trust < self.config.life.death_trust
            )
            (gone if is_double or is_gone else kept).append(person)
        self._register.leave(gone, self._time_s)
        return kept

    def _patience_s(self, person: PanoramicPerson) -> float:
        """Tell for how long somebody may stay unseen."""
        life = self.config.life
        if person.id == 0:
            return life.newcomer_s
        return life.unseen_s if person.occluder is None else life.hidden_s

    def _named(self, persons: Sequence[PanoramicPerson]) -> tuple[PanoramicPerson, ...]:
        named = [
            self._register.named(one, self._time_s) if one.id == 0 and self._is_believed(one) else one
            for one in self._register.put_right(persons, self._time_s)
        ]
        return tuple(sorted(named, key=lambda one: (one.id == 0, one.id)))

    def _is_believed(self, person: PanoramicPerson) -> bool:
        life = self.config.life
        has_stayed = person.sightings > 1 and self._time_s - person.born_s >= life.birth_s - 1e-6
        if not person.is_seen or not (has_stayed or person.sightings >= life.birth_sightings):
            return False
        returns = person.trust >= life.return_trust and self._register.recognised(person, self._time_s)
        return person.trust >= life.birth_trust or bool(returns)

    def _track(self, person: PanoramicPerson, frame: Frame) -> Track:
        later_s = frame.time_s - self._time_s
        motion = person.motion if later_s <= 0 else person.motion.later(later_s, self.config.restlessness)
        x, y = self._pose.locate(motion.place_m).tolist()
        (xx, xy), (_, yy) = self._pose.turned(motion.place_m2 + person.lasting_m2).tolist()
        calibration = frame.calibrations.get(PANORAMA)
        boxes = {}
        if isinstance(calibration, PanoramaCalibration):
            boxes[PANORAMA] = person_box(math.atan2(y, x), math.hypot(x, y), calibration)
        return Track(
            id=person.id,
            boxes=boxes,
            place=FloorPlace(position_m=(x, y), covariance_m2=(xx, xy, yy)),
            confidence=person.confidence,
            status=Status.TRACKED if person.status is Status.TENTATIVE else person.status,
            age_s=frame.time_s - person.born_s,
            occluder=person.occluder,
        )


def _hider(bearing: float, nearer: Sequence[PanoramicPerson], looker: Onlooker) -> int | None:
    """Name who of those that are nearer stands most in the line of sight."""
    seen = [one for one in nearer if one.is_seen and one.id]
    off = {
        one.id: abs(math.remainder(looker.polar(one.motion.place_m)[0] - bearing, math.tau)) for one in seen
    }
    return min(off, key=lambda number: off[number], default=None)


def _way(person: PanoramicPerson, seen: Sighting) -> float:
    return math.dist(person.motion.place_m, seen.place_m)


def _apart(one: PanoramicPerson, other: PanoramicPerson) -> float:
    return math.dist(one.motion.place_m, other.motion.place_m)


def _between(before: RobotPose, now: RobotPose) -> Odometry:
    """Tell how the robot moved from one pose to another."""
    x, y = before.locate(np.array([now.x, now.y])).tolist()
    return Odometry(advance_m=x, aside_m=y, turn_rad=now.heading - before.heading)
