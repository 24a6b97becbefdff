"""The tracker of several people around a standing or moving robot."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PanoramaCalibration
from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.frame import PANORAMA, Frame, Odometry, check_frame
from peopleboy.tracker.panoramic.panorama_view import view_of
from peopleboy.tracker.panoramic.people.band_colours import BandColours
from peopleboy.tracker.panoramic.people.floor_motion import FloorMotion
from peopleboy.tracker.panoramic.people.panorama_patches import PanoramaScene, person_box, promising_places
from peopleboy.tracker.panoramic.people.panoramic_config import PeopleConfig
from peopleboy.tracker.panoramic.people.panoramic_observation import Onlooker, PeopleExplanation, Sighting
from peopleboy.tracker.panoramic.people.panoramic_tracks import Life, PanoramicPerson, Register
from peopleboy.tracker.panoramic.people.place_model import PlaceModel
from peopleboy.tracker.panoramic.people_foreground import Foreground
from peopleboy.tracker.track import FloorPlace, Status, Track

LONGEST_STEP_S = 2.0


class PanoramicTracker:
    """Tracks people on the floor by a learned model of the panorama.

    People are detected from the nearest to the farthest, and each one's pixels are masked for those behind.

    Args:
        model: detects people at positions in the panorama of the camera it was trained for.
        config: settings.
    """

    def __init__(self, model: PlaceModel, config: PeopleConfig | None = None) -> None:
        self.config = PeopleConfig() if config is None else config
        self._model = model
        self._foreground = Foreground()
        self._register = Register(self.config.identity)
        self._pose = Pose2()
        self._camera: PanoramaCalibration | None = None
        self._seen_from: Pose2 | None = None
        self._time_s = -math.inf
        self._persons: tuple[PanoramicPerson, ...] = ()
        self._scene: PanoramaScene | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The panoramic camera."""
        return (PANORAMA,)

    @property
    def explanation(self) -> PeopleExplanation | None:
        """The state at the newest image; None before the first."""
        if self._scene is None:
            return None
        return PeopleExplanation(self._foreground.background, self._scene.foreground, self._scene.covered)

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse a camera that the model was not trained on, before the first frame.

        Raises:
            BadInput: another camera, or one that is not panoramic.
        """
        self._checked(calibrations)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame and return the reported tracks.

        Raises:
            BadInput: the image is invalid, or of a camera that the model was not trained on.
        """
        check_frame(frame)
        if frame.odometry is not None:
            self._pose = self._pose.integrate(frame.odometry.motion)
        if PANORAMA in frame.images:
            self._look(frame)
        return tuple(self._track(person, frame) for person in self._persons if person.id)

    def _look(self, frame: Frame) -> None:
        """Process a new panorama."""
        image, calibration = frame.rgb(PANORAMA), self._checked(frame.calibrations)
        moved = (
            None if self._seen_from is None else Odometry.from_motion(self._pose.relative_to(self._seen_from))
        )
        foreground = self._foreground.update(image, frame.time_s, moved, calibration)
        life = Life(self.config, frame.time_s, min(frame.time_s - self._time_s, LONGEST_STEP_S))
        self._seen_from, self._time_s = self._pose, frame.time_s
        self._scene = scene = PanoramaScene.of(image, foreground, self._foreground.novelty, calibration)
        looker = Onlooker(self._model, self._pose, self.config.sighting)
        known = self._followed(scene, looker, life)
        known = self._with_newcomers(known, scene, looker, life)
        self._persons = self._named(self._kept(known, life), life)

    def _checked(self, calibrations: Mapping[str, Calibration]) -> PanoramaCalibration:
        """Return the camera's calibration, if the model was trained on it."""
        camera = calibrations.get(PANORAMA)
        if camera is self._camera and self._camera is not None:
            return self._camera
        if not isinstance(camera, PanoramaCalibration):
            raise BadInput(f"camera {PANORAMA!r}: the tracker needs a calibrated panoramic camera")
        if why := self._model.view.refusal(view_of(camera, camera.width, camera.height)):
            raise BadInput(f"{why}; no other networks are available")
        self._camera = camera
        return camera

    def _followed(self, scene: PanoramaScene, looker: Onlooker, life: Life) -> list[PanoramicPerson]:
        """Detect all tracked people, the nearest first."""
        config, restlessness = self.config.sighting, self.config.restlessness
        expected = (replace(one, motion=one.motion.later(life.dt_s, restlessness)) for one in self._persons)
        found: list[PanoramicPerson] = []
        for person in sorted(expected, key=lambda one: looker.polar(one.motion.place_m)[1]):
            bearing, distance = looker.polar(person.motion.place_m)
            hidden = scene.hidden_share(bearing, distance)
            seen = looker.expected(person.motion, scene) if hidden < config.blind_share else None
            least = config.hidden_share if seen is None else config.partly_share
            occluder = _hider(bearing, found, looker) if hidden > least else None
            if seen is None:
                found.append(life.unseen(person, occluder))
            else:
                found.append(life.seen(person, seen, _taken(seen, scene), occluder))
        return found

    def _with_newcomers(
        self, known: Sequence[PanoramicPerson], scene: PanoramaScene, looker: Onlooker, life: Life
    ) -> list[PanoramicPerson]:
        """Search for untracked people, who are new or were lost."""
        config, everybody = self.config.life, list(known)
        for polar in promising_places(scene.figures, config.newcomers):
            seen = looker.at(scene, polar[None])
            if seen is None or seen.distance_m > config.farthest_m:
                continue
            if any(one.is_seen and _way(one, seen) < config.apart_m for one in everybody):
                continue
            clothing = _taken(seen, scene)
            lost = [one for one in everybody if life.could_be(one, seen.place_m, clothing)]
            if lost:
                back = min(lost, key=lambda one: _way(one, seen))
                motion = FloorMotion.begin(seen.place_m, seen.error_m2)
                everybody[everybody.index(back)] = life.seen(
                    replace(back, motion=motion), seen, clothing, None
                )
            else:
                everybody.append(life.initiate(seen, clothing))
        return everybody

    def _kept(self, persons: Sequence[PanoramicPerson], life: Life) -> list[PanoramicPerson]:
        """Delete lost tracks and duplicates: of two at one position, the last detected one is kept."""
        kept: list[PanoramicPerson] = []
        gone: list[PanoramicPerson] = []
        for person in sorted(persons, key=lambda one: (-one.seen_s, one.id == 0, one.id)):
            is_double = any(_apart(person, other) < self.config.life.double_m for other in kept)
            (gone if is_double or life.is_gone(person) else kept).append(person)
        self._register.leave(gone, life.time_s)
        return kept

    def _named(self, persons: Sequence[PanoramicPerson], life: Life) -> tuple[PanoramicPerson, ...]:
        """Number confirmed people: with the id of an occluded one who may have reappeared, or a new id."""
        known = list(self._register.resolve_swaps(persons, life.time_s))
        for one in [one for one in known if one.id == 0 and self._is_believed(one, life)]:
            known.remove(one)
            place_m = one.motion.place_m
            hidden = [other for other in known if other.id and life.could_be(other, place_m, one.newest)]
            if hidden:
                back = min(hidden, key=lambda other: _apart(other, one))
                known[known.index(back)] = one.known_as(back)
            else:
                known.append(self._register.named(one, life.time_s))
        return tuple(sorted(known, key=lambda one: (one.id == 0, one.id)))

    def _is_believed(self, person: PanoramicPerson, life: Life) -> bool:
        """Return whether a person has enough evidence; less is needed for one who returns."""
        config = self.config.life
        if not life.is_settled(person) or person.trust < config.return_trust:
            return False
        if person.trust >= config.birth_trust:
            return True
        return self._register.recognised(person, life.time_s) is not None

    def _track(self, person: PanoramicPerson, frame: Frame) -> Track:
        later_s = frame.time_s - self._time_s
        motion = person.motion if later_s <= 0 else person.motion.later(later_s, self.config.restlessness)
        x, y = self._pose.points_to_local(motion.place_m).tolist()
        (xx, xy), (_, yy) = self._pose.covariance_to_local(motion.place_m2 + person.lasting_m2).tolist()
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
    """Return the id of the nearer person who covers the line of sight most."""
    seen = [one for one in nearer if one.is_seen and one.id]
    off = {
        one.id: abs(math.remainder(looker.polar(one.motion.place_m)[0] - bearing, math.tau)) for one in seen
    }
    return min(off, key=lambda number: off[number], default=None)


def _taken(seen: Sighting, scene: PanoramaScene) -> BandColours:
    """Return a person's appearance, and mask the person's pixels."""
    clothing = scene.clothing(seen.bearing_rad, seen.distance_m)
    scene.cover(seen.bearing_rad, seen.distance_m)
    return clothing


def _way(person: PanoramicPerson, seen: Sighting) -> float:
    return math.dist(person.motion.place_m, seen.place_m)


def _apart(one: PanoramicPerson, other: PanoramicPerson) -> float:
    return math.dist(one.motion.place_m, other.motion.place_m)
