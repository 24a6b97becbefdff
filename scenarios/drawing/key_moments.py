"""Choose the few key moments of a run while it is running, without keeping every tick."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.loop.run_events import LogLine, describe
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import shown_to_people
from peopleboy.sim.truth.events import TOTAL_STARTS
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.tracker.track import Status, Track

# Kinds of moments, the most important first, and how many of each kind are kept.
_KINDS = {
    "start": 1,
    "detected": 3,
    "falls": 3,
    "contact starts": 3,
    "fault starts": 3,
    "most hidden": 4,
    "thing moved": 4,
    "thing appeared": 2,
    "thing vanished": 2,
    "closest": 1,
    "occlusion starts": 4,
    "occlusion ends": 4,
    "mode": 6,
    "lost": 3,
    "re-identified": 3,
    "enters view": 4,
    "leaves view": 4,
}
_ORDER = {kind: place for place, kind in enumerate(_KINDS)}
_NEAR_S = 0.19
_SPARE = 24


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """The newest image of a further camera at one instant.

    Attributes:
        camera: its name.
        time_s: [s] when it was taken.
        image: (H, W) or (H, W, 3), 8 bits, prepared for display.
        people: ground truth of the people in it.
        tracks: the tracker's tracks.
    """

    camera: str
    time_s: float
    image: NDArray[np.uint8]
    people: tuple[PersonTruth, ...]
    tracks: tuple[Track, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class KeyMoment:
    """The data needed to draw one instant.

    Attributes:
        frame, time_s, mode: as in the tick.
        thermal, colour: (H, W) and (H, W, 3) images of the cameras, prepared for display.
        further: newest images of the other cameras.
        tracks, explanation: the tracker's tracks, and its explanation of them.
        people: ground truth.
        words: events, the most important first.
    """

    frame: int
    time_s: float
    mode: str
    thermal: NDArray[np.uint8]
    colour: NDArray[np.uint8]
    further: tuple[Shot, ...]
    tracks: tuple[Track, ...]
    explanation: object
    people: tuple[PersonTruth, ...]
    words: tuple[str, ...] = ()


# Describes a moment from the moment that is shown, which may be a neighbour of the one it was made for.
Words = Callable[[KeyMoment], str]


@dataclass(slots=True)
class _Occlusion:
    """The worst of one occlusion so far."""

    slot: tuple[str, int]
    hidden: float = 0.0


class KeyMoments:
    """Collects moments during a run: about 60 at most, however long the run is.

    Args:
        cameras: the robot's cameras by name.
    """

    def __init__(self, cameras: Mapping[str, CameraConfig]) -> None:
        self._cameras = cameras
        self._kept: dict[tuple[str, int], tuple[KeyMoment, Words]] = {}
        self._newest: dict[str, Shot] = {}
        self._counts: Counter[str] = Counter()
        self._occlusions: dict[tuple[str, str], _Occlusion] = {}
        self._closest_m = np.inf
        self._spare: list[KeyMoment] = []
        self._stride = 1

    def add(self, tick: Tick, events: Sequence[LogLine]) -> None:
        """Add one tick and its events."""
        self._newest |= {shot.camera: shot for shot in _further(tick, self._cameras)}
        moment = _moment(tick, tuple(self._newest.values()))
        if not self._spare:
            self._keep_new("start", moment, partial(_always, "start"))
        for line in events:
            self._keep_new(line.kind, moment, partial(_always, describe(line)))
            self._follow_occlusion(line)
        self._look_for_worst(moment)
        self._look_for_closest(moment)
        self._keep_spare(moment)

    def choose(self, count: int) -> list[KeyMoment]:
        """Return at most `count` moments in time order: events, then moments as far from them as possible."""
        chosen: list[KeyMoment] = []
        words: dict[int, tuple[str, ...]] = {}
        # The first moment of every kind is chosen before the second of any kind.
        for _, (moment, say) in sorted(
            self._kept.items(), key=lambda item: (item[0][1], _ORDER[item[0][0]], item[1][0].frame)
        ):
            same = next((m for m in chosen if abs(m.time_s - moment.time_s) < _NEAR_S), None)
            if same is not None:
                words[same.frame] += (say(same),)
            elif len(chosen) < count - count // 6:  # the rest is reserved for moments without an event
                chosen.append(moment)
                words[moment.frame] = (say(moment),)
        self._fill(chosen, count)
        return [_with_words(m, words.get(m.frame, ())) for m in sorted(chosen, key=lambda m: m.frame)]

    def _keep_new(self, kind: str, moment: KeyMoment, say: Words) -> tuple[str, int] | None:
        """Keep a moment of this kind if there is room for it, and return its key."""
        slot = (kind, self._counts[kind])
        if slot[1] >= _KINDS.get(kind, 0):
            return None
        self._counts[kind] += 1
        self._kept[slot] = (moment, say)
        return slot

    def _follow_occlusion(self, line: LogLine) -> None:
        pair = (line.who, line.other)
        if line.kind == "occlusion starts":
            number = self._counts["most hidden"]
            if number < _KINDS["most hidden"]:
                self._counts["most hidden"] += 1
                self._occlusions[pair] = _Occlusion(("most hidden", number))
        elif line.kind == "occlusion ends":
            self._occlusions.pop(pair, None)

    def _look_for_worst(self, moment: KeyMoment) -> None:
        people = {person.name: person for person in moment.people}
        for (name, other), occlusion in self._occlusions.items():
            person = people.get(name)
            hidden = 0.0 if person is None else person.hidden_inside(other)
            if person is not None and hidden > occlusion.hidden:
                occlusion.hidden = hidden
                self._kept[occlusion.slot] = (moment, partial(_hidden, person, other))

    def _look_for_closest(self, moment: KeyMoment) -> None:
        for person in moment.people:
            if person.visible_px > 0 and person.distance_m < self._closest_m:
                self._closest_m = person.distance_m
                text = f"closest in view: {person.name}, {person.distance_m:.1f} m"
                self._kept[("closest", 0)] = (moment, partial(_always, text))

    def _keep_spare(self, moment: KeyMoment) -> None:
        """Keep every n-th moment as a spare; n doubles whenever there are too many."""
        if (moment.frame - 1) % self._stride == 0:
            self._spare.append(moment)
        if len(self._spare) > _SPARE:
            self._stride *= 2
            self._spare = [m for m in self._spare if (m.frame - 1) % self._stride == 0]

    def _fill(self, chosen: list[KeyMoment], count: int) -> None:
        """Add spare moments, each time the one farthest from all chosen moments."""
        while len(chosen) < count:
            gaps = [min(abs(spare.frame - m.frame) for m in chosen) for spare in self._spare]
            if not gaps or max(gaps) == 0:
                return
            chosen.append(self._spare[gaps.index(max(gaps))])


def _always(text: str, moment: KeyMoment) -> str:  # noqa: ARG001
    return text


def _hidden(person: PersonTruth, other: str, moment: KeyMoment) -> str:
    """Describe how much of a person another one hides at the moment that is shown."""
    shown = next((one for one in moment.people if one.name == person.name), person)
    hidden = shown.hidden_inside(other)
    if hidden > TOTAL_STARTS:
        return f"{shown.name}: out of sight behind {other}"
    return f"{shown.name}: {hidden:.0%} hidden by {other}"


def _further(tick: Tick, cameras: Mapping[str, CameraConfig]) -> Iterator[Shot]:
    """Return the newest images of the cameras other than thermal and colour."""
    for name in (name for name in tick.truths if name not in ("thermal", "colour")):
        senses, truth = tick.observation, tick.truths[name]
        image = shown_to_people(senses.images, name, cameras[name])
        yield Shot(name, senses.time_s, image, truth.people, tick.tracks)


def _moment(tick: Tick, further: tuple[Shot, ...]) -> KeyMoment:
    senses = tick.observation
    return KeyMoment(
        frame=tick.frame,
        time_s=senses.time_s,
        mode=tick.mode,
        thermal=senses.images["thermal_scene"],
        colour=senses.images["colour"],
        further=further,
        tracks=tick.tracks,
        explanation=tick.explanation,
        people=tick.truth.people,
    )


def _with_words(moment: KeyMoment, words: tuple[str, ...]) -> KeyMoment:
    """Describe the events of a moment, or, without any, how many people are in view and tracked."""
    if not words:
        seen = sum(person.visible_px > 0 for person in moment.people)
        sure = sum(track.status is not Status.TENTATIVE for track in moment.tracks)
        words = (f"{seen} in view, {sure} tracked",)
    return replace(moment, words=words)
