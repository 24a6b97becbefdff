"""A tracker whose people keep their numbers however long they were away, and no stranger gets one."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Generic, Protocol

import numpy as np

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.tracker.attention.people.attentive_config import AttentiveConfig
from peopleboy.tracker.attention.people.attentive_explanation import (
    Attended,
    AttentiveExplanation,
    renumbered,
)
from peopleboy.tracker.attention.people.person_views import LOOKED_AT, check_colours, views_of
from peopleboy.tracker.attention.people.recogniser import Appearance, Recogniser, Seen
from peopleboy.tracker.frame import COLOUR, Frame, check_frame
from peopleboy.tracker.track import Status, Track

# A person who is known by its appearance, and a track that a person may wear.

_OF_LATE: Final = 0.05  # share of the newest image in the usual score


@dataclass(slots=True)
class GalleryEntry(Generic[Appearance]):
    """A person as it looked.

    Attributes:
        number: of the person's tracks.
        appearance: by camera.
        images: in which it was learned, by camera.
        usual: score that it has of late while it is there.
        seen_s: [s] when it was seen last.
    """

    number: int
    models: dict[str, Appearance] = field(default_factory=dict)
    images: dict[str, int] = field(default_factory=dict)
    usual: float = 0.0
    seen_s: float = -np.inf

    def is_known(self, config: AttentiveConfig) -> bool:
        """Return whether enough was seen of the person to know it again."""
        return max(self.images.values(), default=0) >= config.learned_images

    def score(self, seen: Mapping[str, Seen], recogniser: Recogniser[Appearance, Seen]) -> float | None:
        """Score a person who is seen, by camera; None where none saw both."""
        scores = [
            recogniser.score(self.models[camera], one)
            for camera, one in seen.items()
            if camera in self.models
        ]
        return float(np.mean(scores)) if scores else None

    def needed(self, config: AttentiveConfig) -> float:
        """Return the score from which a new person is this one: higher, the less the appearance varies."""
        return max(config.accept, self.usual - config.slack)

    def note(self, score: float) -> None:
        """Take in the score of an image in which the person is there."""
        self.usual += _OF_LATE * (score - self.usual) if self.usual else score

    def learn(
        self,
        seen: Mapping[str, Seen],
        recogniser: Recogniser[Appearance, Seen],
        config: AttentiveConfig,
    ) -> None:
        """Take in what is seen of the person: of the first images all alike, of later ones little."""
        for camera, one in seen.items():
            count = self.images[camera] = self.images.get(camera, 0) + 1
            rate = 1.0 / count if count <= config.first_images else config.rate
            self.models[camera] = recogniser.learned(self.models.get(camera), one, rate)


@dataclass(slots=True)
class Wearer:
    """A track of the tracker below, and who that is.

    Attributes:
        number: of the person; None for one who is known to be elsewhere.
        since_s: [s] since when it has been this track without a longer break.
        seen_s: [s] when it was seen last.
        is_new: whether it may still turn out to be a person who was lost.
        scores: of late, by the number of those that it may be; its own among them.
    """

    number: int | None
    since_s: float
    seen_s: float
    is_new: bool = True
    scores: dict[int, deque[float]] = field(default_factory=dict)

    def note(self, number: int, score: float, most: int) -> None:
        """Remember a score."""
        self.scores.setdefault(number, deque(maxlen=most)).append(score)

    def mean(self, number: int, least: int) -> float | None:
        """Return the mean of the newest scores; None if there are too few."""
        scores = self.scores.get(number, ())
        return float(np.mean(scores)) if len(scores) >= least else None


class Below(Protocol):
    """The tracker that finds people."""

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras whose images it wants."""
        ...

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is seen."""
        ...


class AttentiveTracker(Generic[Appearance, Seen]):
    """Renames the tracks of another tracker by what people look like.

    It learns everybody who is seen, from the boxes of their tracks. After a loss only new tracks are scored,
    each by itself: from a threshold on one has the number of who was lost; below it, it stays a stranger.
    Who comes out from behind others keeps the number that the tracker below gives, if it does not look like
    another person.

    Args:
        below: finds people.
        recogniser: identifies them by their appearance.
        config: how sure it must be.

    Source: situation-awareness thesis, chapter 5 and its outlook, which proposes it: the first box is the
    tracker's, and people are known again after a long absence.
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
        """Those of the tracker below, and the colour camera if none of them shows colours."""
        cameras = self._below.cameras
        return cameras if any(name in LOOKED_AT for name in cameras) else (*cameras, COLOUR)

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse cameras that the tracker below cannot see by.

        Raises:
            BadInput: there is one.
        """
        check = getattr(self._below, "check_cameras", None)
        if check is not None:
            check(calibrations)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is seen, each by its own number.

        Raises:
            BadInput: no camera shows colours, and as the tracker below says.
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
        """What the tracker below believes, by the track ids, and how sure these are."""
        likeness = {}
        for wearer in self._wearers.values():
            mean = None if wearer.number is None else wearer.mean(wearer.number, least=1)
            if mean is not None and wearer.number is not None and wearer.seen_s == self._time_s:
                likeness[wearer.number] = mean
        below = renumbered(getattr(self._below, "explanation", None), self._reported)
        return AttentiveExplanation(below, likeness, self._attended)

    def _meet(self, track: Track, time_s: float) -> None:
        """Find who a track was, should it be there without a longer break."""
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
        """Let a track that is seen whole be a person who was lost, or nobody any more; learn who it is."""
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
        """Prepare a new image in which to search for the attended person."""
        attended = self._attended
        if attended is not None and attended.camera in frame.images:
            self._attended = replace(attended, image=frame.rgb(attended.camera))

    def _recognise(self, wearer: Wearer, seen: Mapping[str, Seen]) -> None:
        """Give a new person the id of the lost person that it resembles most, if it resembles one."""
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
        """Return a known person's number to a track; who is only thought to be there has none any more."""
        for other in self._wearers.values():
            if other.number == number:
                other.number = None
        self._people.pop(wearer.number or 0, None)
        self._people[number].seen_s = wearer.seen_s
        wearer.number, wearer.is_new = number, False

    def _is_doubtful(self, wearer: Wearer) -> bool:
        """Return whether a track has looked otherwise than its person for a while: it is on another one."""
        mean = wearer.mean(wearer.number or 0, self._config.doubtful_images)
        return mean is not None and mean < self._config.reject

    def _rename(self, wearer: Wearer, number: int, time_s: float) -> None:
        """Let a track be a stranger from now on."""
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
        """Forget who has been away for too long, and tracks that cannot come back."""
        oldest_s = time_s - self._config.remembered_s
        self._wearers = {below: one for below, one in self._wearers.items() if one.seen_s >= oldest_s}
        worn = {wearer.number for wearer in self._wearers.values()}
        self._people = {
            number: person
            for number, person in self._people.items()
            if number in worn or (person.seen_s >= oldest_s and person.is_known(self._config))
        }

    def _renamed(self, tracks: Sequence[Track]) -> tuple[Track, ...]:
        """Return tracks, and those who hide them, their numbers; who may be born next has the next one."""
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
