"""A tracker wrapper that re-identifies people by appearance, however long they were absent."""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Generic, Protocol

import numpy as np

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.tracker.frame import COLOUR, Frame, check_frame
from peopleboy.tracker.reproductions.attention.people.attentive_config import AttentiveConfig
from peopleboy.tracker.reproductions.attention.people.attentive_explanation import (
    Attended,
    AttentiveExplanation,
    renumbered,
)
from peopleboy.tracker.reproductions.attention.people.person_views import LOOKED_AT, check_colours, views_of
from peopleboy.tracker.reproductions.attention.people.recogniser import Appearance, Recogniser, Seen
from peopleboy.tracker.track import Status, Track

# Gallery entries, and the identities of the wrapped tracker's tracks.

_OF_LATE: Final = 0.05  # weight of the newest image in the usual score


@dataclass(slots=True)
class GalleryEntry(Generic[Appearance]):
    """Gallery entry of a person.

    Attributes:
        number: id of the person.
        appearance: model by camera.
        images: number of learned images by camera.
        usual: running mean of the score while visible.
        seen_s: [s] time of the last observation.
    """

    number: int
    models: dict[str, Appearance] = field(default_factory=dict)
    images: dict[str, int] = field(default_factory=dict)
    usual: float = 0.0
    seen_s: float = -np.inf

    def is_known(self, config: AttentiveConfig) -> bool:
        """Return whether enough images were learned for re-identification."""
        return max(self.images.values(), default=0) >= config.learned_images

    def score(self, seen: Mapping[str, Seen], recogniser: Recogniser[Appearance, Seen]) -> float | None:
        """Return the score of an observed person; None if no camera has seen both."""
        scores = [
            recogniser.score(self.models[camera], one)
            for camera, one in seen.items()
            if camera in self.models
        ]
        return float(np.mean(scores)) if scores else None

    def needed(self, config: AttentiveConfig) -> float:
        """Return the acceptance threshold: higher for people whose appearance varies less."""
        return max(config.accept, self.usual - config.slack)

    def note(self, score: float) -> None:
        """Update the usual score with an image of the person."""
        self.usual += _OF_LATE * (score - self.usual) if self.usual else score

    def learn(
        self,
        seen: Mapping[str, Seen],
        recogniser: Recogniser[Appearance, Seen],
        config: AttentiveConfig,
    ) -> None:
        """Update the appearance: the first images have equal weights, later ones less."""
        for camera, one in seen.items():
            count = self.images[camera] = self.images.get(camera, 0) + 1
            rate = 1.0 / count if count <= config.first_images else config.rate
            self.models[camera] = recogniser.learned(self.models.get(camera), one, rate)


@dataclass(slots=True)
class Wearer:
    """Identity of one track of the wrapped tracker.

    Attributes:
        number: id of the person; None for a track that left its person.
        since_s: [s] start of the track, or of its last part after a long gap.
        seen_s: [s] time of the last observation.
        is_new: whether it may still be a lost person.
        scores: recent scores by candidate id, including its own.
    """

    number: int | None
    since_s: float
    seen_s: float
    is_new: bool = True
    scores: dict[int, deque[float]] = field(default_factory=dict)

    def note(self, number: int, score: float, most: int) -> None:
        """Add a score."""
        self.scores.setdefault(number, deque(maxlen=most)).append(score)

    def mean(self, number: int, least: int) -> float | None:
        """Return the mean of the newest scores; None if there are too few."""
        scores = self.scores.get(number, ())
        return float(np.mean(scores)) if len(scores) >= least else None


class Below(Protocol):
    """The wrapped tracker."""

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the required cameras."""
        ...

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame and return the tracks."""
        ...


class AttentiveTracker(Generic[Appearance, Seen]):
    """Replaces the ids of another tracker by re-identified ones.

    It learns the appearance of everybody from the boxes of their tracks. After a loss only new tracks are
    scored, each independently: above a threshold a track gets the lost person's id, and below it a new one. A
    person who reappears from behind others keeps the wrapped tracker's id, unless the appearance differs.

    Args:
        below: the wrapped tracker.
        recogniser: compares appearances.
        config: thresholds.

    Source: situation-awareness thesis, chapter 5 and its outlook, which proposes to take the first box from
    the tracker, and to re-identify people after a long absence.
    """

    knows_again = True

    def __init__(
        self,
        below: Below,
        recogniser: Recogniser[Appearance, Seen],
        config: AttentiveConfig | None = None,
    ) -> None:
        self._below, self._recogniser = below, recogniser
        self._config = AttentiveConfig() if config is None else config
        self._people: dict[int, GalleryEntry[Appearance]] = {}
        self._wearers: dict[int, Wearer] = {}
        self._reported: dict[int, int] = {}
        self._newest = 0
        self._time_s = 0.0
        self._attended: Attended | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The wrapped tracker's cameras, and the colour camera if none of them has colours."""
        cameras = self._below.cameras
        return cameras if any(name in LOOKED_AT for name in cameras) else (*cameras, COLOUR)

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse cameras that the wrapped tracker cannot use.

        Raises:
            BadInput: a camera is unsuitable.
        """
        check = getattr(self._below, "check_cameras", None)
        if check is not None:
            check(calibrations)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame and return the tracks with re-identified ids.

        Raises:
            BadInput: no camera has colours, or raised by the wrapped tracker.
        """
        check_frame(frame)
        check_colours(frame)
        self._time_s = frame.time_s
        self._attend(frame)
        tracks = self._below.update(frame)
        sure = [track for track in tracks if track.status is not Status.TENTATIVE]
        self._forget(frame.time_s)
        for track in sure:
            self._meet(track, frame.time_s)
        for track in sure:
            self._compare(track, frame)
        return self._renamed(tracks)

    @property
    def explanation(self) -> AttentiveExplanation:
        """The wrapped tracker's explanation by id, and the similarities."""
        likeness = {}
        for wearer in self._wearers.values():
            mean = None if wearer.number is None else wearer.mean(wearer.number, least=1)
            if mean is not None and wearer.number is not None and wearer.seen_s == self._time_s:
                likeness[wearer.number] = mean
        below = renumbered(getattr(self._below, "explanation", None), self._reported)
        return AttentiveExplanation(below, likeness, self._attended)

    def _meet(self, track: Track, time_s: float) -> None:
        """Return a track's identity, unless there was a long gap."""
        is_visible = track.status is not Status.TOTALLY_OCCLUDED
        wearer = self._wearers.get(track.id)
        if wearer is None:
            wearer = self._wearers[track.id] = Wearer(self._new(time_s), time_s, time_s)
        elif is_visible and time_s - wearer.seen_s > self._config.gap_s:
            if wearer.number is None or time_s - wearer.seen_s > self._config.proof_s:
                wearer.number, wearer.is_new = self._new(time_s), True
            wearer.since_s = time_s
            wearer.scores.clear()
        if is_visible and wearer.number is not None:
            wearer.seen_s = self._people[wearer.number].seen_s = time_s

    def _compare(self, track: Track, frame: Frame) -> None:
        """Re-identify, reject or learn the person of a fully visible track."""
        wearer = self._wearers[track.id]
        if track.status is not Status.TRACKED or wearer.number is None:
            return
        views = {view.camera: view for view in views_of(track, frame)}
        glimpses = {camera: self._recogniser.see(view) for camera, view in views.items()}
        seen = {camera: one for camera, one in glimpses.items() if one is not None}
        if not seen:
            return
        if wearer.is_new:
            self._recognise(wearer, seen)
        score = self._score(wearer, wearer.number, seen)
        if self._is_doubtful(wearer):
            self._rename(wearer, self._new(frame.time_s), frame.time_s)
            score = None
        own = self._people[wearer.number]
        if score is None or score >= self._config.doubt or not own.is_known(self._config):
            own.learn(seen, self._recogniser, self._config)
            if score is not None and own.is_known(self._config):
                own.note(score)
        if self._attended is None and own.is_known(self._config):
            self._attended = Attended.learned(own.number, views[next(iter(seen))])

    def _attend(self, frame: Frame) -> None:
        """Prepare the newest image for the search for the attended person."""
        attended = self._attended
        if attended is not None and attended.camera in frame.images:
            self._attended = replace(attended, image=frame.rgb(attended.camera))

    def _recognise(self, wearer: Wearer, seen: Mapping[str, Seen]) -> None:
        """Give a new person the id of the most similar lost person, if similar enough."""
        config, found = self._config, {}
        for number, person in self._people.items():
            if number != wearer.number and person.seen_s < wearer.since_s and person.is_known(config):
                self._score(wearer, number, seen)
                mean = wearer.mean(number, config.least_images)
                if mean is not None and mean >= person.needed(config):
                    found[number] = mean
        if found:
            self._take(wearer, max(found, key=lambda number: found[number]))

    def _take(self, wearer: Wearer, number: int) -> None:
        """Give a track a known person's id; a coasting track with that id loses it."""
        for other in self._wearers.values():
            if other.number == number:
                other.number = None
        self._people.pop(wearer.number or 0, None)
        self._people[number].seen_s = wearer.seen_s
        wearer.number, wearer.is_new = number, False

    def _is_doubtful(self, wearer: Wearer) -> bool:
        """Return whether a track's appearance has differed for a while, so that it follows another person."""
        mean = wearer.mean(wearer.number or 0, self._config.doubtful_images)
        return mean is not None and mean < self._config.reject

    def _rename(self, wearer: Wearer, number: int, time_s: float) -> None:
        """Make a track a stranger."""
        wearer.number, wearer.is_new, wearer.since_s = number, True, time_s
        wearer.scores.clear()

    def _score(self, wearer: Wearer, number: int, seen: Mapping[str, Seen]) -> float | None:
        score = self._people[number].score(seen, self._recogniser)
        if score is not None:
            wearer.note(number, score, self._config.images)
        return score

    def _new(self, time_s: float) -> int:
        self._newest += 1
        self._people[self._newest] = GalleryEntry(self._newest, seen_s=time_s)
        return self._newest

    def _forget(self, time_s: float) -> None:
        """Forget people after a long absence, and tracks that cannot return."""
        oldest_s = time_s - self._config.remembered_s
        self._wearers = {below: one for below, one in self._wearers.items() if one.seen_s >= oldest_s}
        worn = {wearer.number for wearer in self._wearers.values()}
        self._people = {
            number: person
            for number, person in self._people.items()
            if number in worn or (person.seen_s >= oldest_s and person.is_known(self._config))
        }

    def _renamed(self, tracks: Sequence[Track]) -> tuple[Track, ...]:
        """Replace the ids of tracks and of their occluders; a track without one gets the next id."""
        number = {track.id: self._number(track) for track in tracks}
        self._reported = {below: own for below, own in number.items() if own is not None}
        named = (
            replace(track, id=own, occluder=number.get(track.occluder or 0))
            for track in tracks
            if (own := number[track.id]) is not None
        )
        return tuple(sorted(named, key=lambda track: track.id))

    def _number(self, track: Track) -> int | None:
        return self._newest + 1 if track.status is Status.TENTATIVE else self._wearers[track.id].number
