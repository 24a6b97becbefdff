"""A tracker wrapper that re-identifies people by appearance, however long they were absent."""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Final, Generic, Protocol

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.tracker.frame import COLOUR, Frame, check_frame
from peopleboy.tracker.reproductions.attention.attentive_explanation import Attended, AttentiveExplanation
from peopleboy.tracker.reproductions.attention.person_views import LOOKED_AT, check_colours, views_of
from peopleboy.tracker.reproductions.attention.recogniser import Appearance, Recogniser, Seen
from peopleboy.tracker.reproductions.contour.explanation import ContourExplanation
from peopleboy.tracker.track import Status, Track


@dataclass(frozen=True, slots=True, kw_only=True)
class AttentiveConfig:
    """How appearance is learned, and the similarity required for re-identification.

    Attributes:
        accept: mean score from which a new person is a lost one.
        images: number of newest images that scores are averaged over ...
        least_images: ... and their least number.
        learned_images: least number of learned images for re-identification.
        rate: least weight of a new image in the remembered appearance.
        doubt: score below which the appearance is not updated.
        gap_s: [s] out of sight after which scores are collected anew ...
        proof_s: [s] ... and after which the wrapped tracker's id is not trusted.
        remembered_s: [s] after which a lost person is forgotten.

    Raises:
        BadInput: a value out of range.
    """

    accept: float = 0.62
    images: int = 8
    least_images: int = 2
    learned_images: int = 5
    rate: float = 0.02
    doubt: float = 0.6
    gap_s: float = 0.5
    proof_s: float = 2.0
    remembered_s: float = 600.0

    def __post_init__(self) -> None:
        """Check the values."""
        for name in ("accept", "rate", "doubt"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise BadInput(f"AttentiveConfig: {name} must be in 0..1, got {getattr(self, name)}")
        for name in (one.name for one in fields(self)):
            if not getattr(self, name) >= 0:
                raise BadInput(f"AttentiveConfig: {name} must be 0 or more, got {getattr(self, name)}")


AS_FOUND: Final = AttentiveConfig(accept=0.24, doubt=0.0)
"""For the focus of attention as printed: it may miss a person who is there, so a low score means little;
and if no feature speaks for the box, patterns alone give a score of a quarter."""


@dataclass(slots=True)
class GalleryEntry(Generic[Appearance]):
    """What is remembered of a person.

    Attributes:
        seen_s: [s] time of the last observation.
        appearance: the learned model; None before the first clear image.
        images: number of learned images.
    """

    seen_s: float
    appearance: Appearance | None = None
    images: int = 0


@dataclass(slots=True)
class TrackIdentity:
    """The person that a track of the wrapped tracker follows.

    Attributes:
        number: id of the person; None for a track that left its person.
        since_s: [s] start of the track, or of its last part after a long gap.
        seen_s: [s] time of the last observation.
        is_new: whether it may still be a lost person.
        scores: recent scores by id of a person, including its own.
    """

    number: int | None
    since_s: float
    seen_s: float
    is_new: bool = True
    scores: dict[int, deque[float]] = field(default_factory=dict)

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

    It learns the appearance of all people from the boxes of their tracks. After a loss only new tracks are
    scored, each independently: above a threshold a track gets the lost person's id, and below it a new one. A
    person who reappears from behind others keeps the wrapped tracker's id.

    Args:
        below: the wrapped tracker.
        recogniser: compares appearances.
        config: thresholds.

    Source: situation-awareness thesis, chapter 5 and its outlook, which proposes to take the first box from
    the tracker, and to re-identify people after a long absence.
    """

    def __init__(
        self,
        below: Below,
        recogniser: Recogniser[Appearance, Seen],
        config: AttentiveConfig | None = None,
    ) -> None:
        self._below, self._recogniser = below, recogniser
        self._config = AttentiveConfig() if config is None else config
        self._people: dict[int, GalleryEntry[Appearance]] = {}
        self._identities: dict[int, TrackIdentity] = {}
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
        if self._attended is not None and self._attended.camera in frame.images:
            self._attended = replace(self._attended, image=frame.rgb(self._attended.camera))
        tracks = self._below.update(frame)
        sure = [track for track in tracks if track.status is not Status.TENTATIVE]
        self._forget(frame.time_s)
        for track in sure:
            self._continue(track, frame.time_s)
        for track in sure:
            self._compare(track, frame)
        return self._renumbered(tracks)

    @property
    def explanation(self) -> AttentiveExplanation:
        """The wrapped tracker's explanation by id, and the similarities."""
        likeness = {}
        for one in self._identities.values():
            mean = None if one.number is None else one.mean(one.number, least=1)
            if mean is not None and one.number is not None and one.seen_s == self._time_s:
                likeness[one.number] = mean
        below = getattr(self._below, "explanation", None)
        if isinstance(below, ContourExplanation):
            below = below.renumbered(self._reported)
        return AttentiveExplanation(below, likeness, self._attended)

    def _continue(self, track: Track, time_s: float) -> None:
        """Update a track's identity: after a long gap, the wrapped tracker's id is not trusted."""
        is_visible = track.status is not Status.TOTALLY_OCCLUDED
        one = self._identities.get(track.id)
        if one is None:
            one = self._identities[track.id] = TrackIdentity(self._new(time_s), time_s, time_s)
        elif is_visible and time_s - one.seen_s > self._config.gap_s:
            if one.number is None or time_s - one.seen_s > self._config.proof_s:
                one.number, one.is_new = self._new(time_s), True
            one.since_s = time_s
            one.scores.clear()
        if is_visible and one.number is not None:
            one.seen_s = self._people[one.number].seen_s = time_s

    def _compare(self, track: Track, frame: Frame) -> None:
        """Re-identify and learn the person of a fully visible track."""
        one, config = self._identities[track.id], self._config
        if track.status is not Status.TRACKED or one.number is None:
            return
        for view in views_of(track, frame):
            if (seen := self._recogniser.see(view)) is not None:
                break
        else:
            return
        if one.is_new:
            self._reidentify(one, seen)
        own = self._people[one.number]
        score = self._score(one, one.number, seen)
        if score is None or score >= config.doubt or own.images < config.learned_images:
            own.images += 1
            rate = max(1.0 / own.images, config.rate)
            own.appearance = self._recogniser.learned(own.appearance, seen, rate)
        if self._attended is None and own.images >= config.learned_images:
            self._attended = Attended.learned(one.number, view)

    def _reidentify(self, one: TrackIdentity, seen: Seen) -> None:
        """Give a new person the id of the most similar lost person, if similar enough.

        A coasting track with that id loses it.
        """
        config, found = self._config, {}
        for number, person in self._people.items():
            if (
                person.seen_s < one.since_s
                and person.images >= config.learned_images
                and number != one.number
            ):
                self._score(one, number, seen)
                mean = one.mean(number, config.least_images)
                if mean is not None and mean >= config.accept:
                    found[number] = mean
        if not found:
            return
        number = max(found, key=lambda number: found[number])
        for other in self._identities.values():
            if other.number == number:
                other.number = None
        self._people.pop(one.number or 0, None)
        self._people[number].seen_s = one.seen_s
        one.number, one.is_new = number, False

    def _score(self, one: TrackIdentity, number: int, seen: Seen) -> float | None:
        """Compare a track with a person, and collect the score; None for a person without appearance."""
        known = self._people[number].appearance
        if known is None:
            return None
        score = self._recogniser.score(known, seen)
        one.scores.setdefault(number, deque(maxlen=self._config.images)).append(score)
        return score

    def _new(self, time_s: float) -> int:
        self._newest += 1
        self._people[self._newest] = GalleryEntry(time_s)
        return self._newest

    def _forget(self, time_s: float) -> None:
        """Forget people after a long absence, and tracks that cannot return."""
        oldest_s, least = time_s - self._config.remembered_s, self._config.learned_images
        self._identities = {key: one for key, one in self._identities.items() if one.seen_s >= oldest_s}
        kept = {one.number for one in self._identities.values()}
        self._people = {
            number: person
            for number, person in self._people.items()
            if number in kept or (person.seen_s >= oldest_s and person.images >= least)
        }

    def _renumbered(self, tracks: Sequence[Track]) -> tuple[Track, ...]:
        """Replace the ids of tracks and of their occluders; a tentative track gets the next id."""
        number = {
            track.id: self._newest + 1
            if track.status is Status.TENTATIVE
            else self._identities[track.id].number
            for track in tracks
        }
        self._reported = {below: own for below, own in number.items() if own is not None}
        named = (
            replace(track, id=own, occluder=number.get(track.occluder or 0))
            for track in tracks
            if (own := number[track.id]) is not None
        )
        return tuple(sorted(named, key=lambda track: track.id))
