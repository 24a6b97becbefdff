"""Changes of objects: an object that disappears and appears elsewhere was moved, by the person near it."""

import math
from collections import deque
from collections.abc import Container, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.scene_model.scene import Change, Happening, ScenePerson
from peopleboy.tracker.scene_model.scene_config import ThingsConfig
from peopleboy.tracker.scene_model.things import Thing

_REMEMBERED_S: Final = 40.0
_TALL_M: Final = 1.1
_BODY_M: Final = 0.7
_LEAVES_S: Final = 2.5
_HELD_M: Final = 0.9
_SHADE: Final = 0.5
_SLACK_S: Final = 1.0  # by which an object may seem to appear before it disappears
_BESIDE_S: Final = 0.7  # before and after a change, in which the person responsible is near


@dataclass(slots=True, eq=False)
class _Half:
    """An object that disappeared or appeared, until its counterpart is found."""

    thing: Thing
    since_s: float
    is_known: bool = False
    is_paired: bool = False


class Ledger:
    """Delays disappearances and appearances until it is clear which belong together.

    Args:
        config: settings.
    """

    def __init__(self, config: ThingsConfig) -> None:
        self._config = config
        self._gone: list[_Half] = []
        self._come: list[_Half] = []
        self._known: list[_Half] = []
        self._first: dict[int, tuple[float, tuple[float, float]]] = {}
        self._people: deque[tuple[float, tuple[ScenePerson, ...]]] = deque()

    def note(self, time_s: float, persons: tuple[ScenePerson, ...]) -> None:
        """Store the positions of people."""
        self._people.append((time_s, persons))
        while self._people and self._people[0][0] < time_s - _REMEMBERED_S:
            self._people.popleft()
        for person in persons:
            self._first.setdefault(person.id, (time_s, person.place_m))

    def finished(self, time_s: float) -> list[Happening]:
        """Return the remaining changes, at the end."""
        return self._news(time_s, (), is_over=True)

    def reported(
        self, time_s: float, come: Sequence[Thing], gone: Sequence[Thing], unseen: Container[int] = ()
    ) -> list[Happening]:
        """Add settled and disappeared objects, and return the changes that are certain by now.

        An object that disappears before it was reported was only held still by a person who carries it. An
        object that is occluded again waits, as it may have disappeared.

        Args:
            time_s: of the frame [s].
            come: objects that settled.
            gone: objects that disappeared.
            unseen: ids of occluded objects.
        """
        halted = {one.thing.id for one in self._come} & {one.id for one in gone}
        self._come = [one for one in self._come if one.thing.id not in halted]
        self._come += [_Half(one, time_s) for one in come]
        news = [one for one in gone if one.id not in halted and not self._was_person(one)]
        self._gone += [_Half(one, time_s) for one in news]
        return self._news(time_s, unseen, is_over=False)

    def _news(self, time_s: float, unseen: Container[int], *, is_over: bool) -> list[Happening]:
        config, happenings = self._config, list[Happening]()
        for half in self._come:
            waited_s = math.inf if is_over else time_s - half.since_s
            if half.thing.id in unseen or (waited_s < config.hold_s and self._is_held(half.thing)):
                continue
            origin = self._origin(half.thing)
            if origin is not None:
                half.is_paired = origin.is_paired = True
                happenings.append(self._moved(origin.thing, half.thing, time_s))
            elif waited_s >= config.wait_s:
                half.is_known = True
                happenings.append(self._single(Change.APPEARED, half.thing, time_s))
        for half in self._gone:
            arrived = None if half.is_paired or half.is_known else self._arrived(half.thing)
            if arrived is not None:
                half.is_paired = arrived.is_paired = True
                happenings.append(self._moved(half.thing, arrived.thing, time_s))
            waited_s = math.inf if is_over else time_s - half.since_s
            if not half.is_known and not half.is_paired and waited_s >= config.wait_s:
                half.is_known = True
                happenings.append(self._single(Change.VANISHED, half.thing, time_s))
        limit = time_s - self._config.pair_s - self._config.wait_s
        self._known = [one for one in (*self._known, *self._come) if one.is_known and one.since_s > limit]
        self._known = [one for one in self._known if not one.is_paired]
        self._come = [one for one in self._come if not (one.is_known or one.is_paired)]
        self._gone = [one for one in self._gone if not one.is_paired and one.since_s > limit]
        return happenings

    def missing(self) -> Thing | None:
        """Return the last disappeared object that has not reappeared, or None."""
        return self._gone[-1].thing if self._gone else None

    def _is_held(self, thing: Thing) -> bool:
        """Return whether a person is near enough to hold an object."""
        if not self._people:
            return False
        _, persons = self._people[-1]
        return any(math.dist(one.place_m, thing.place_m[:2]) < _HELD_M for one in persons)

    def _was_person(self, gone: Thing) -> bool:
        """Return whether a disappeared object was a person who stood still before being detected."""
        return gone.top_m > _TALL_M and any(
            math.dist(place, gone.place_m[:2]) < _BODY_M and abs(time_s - gone.span_s[1]) < _LEAVES_S
            for time_s, place in self._first.values()
        )

    def _origin(self, thing: Thing) -> _Half | None:
        """Return the disappeared object that is most similar to one that appeared."""
        likeness = {k: self._alike(one.thing, thing) for k, one in enumerate(self._gone) if not one.is_paired}
        likely = {k: value for k, value in likeness.items() if value > 0.0}
        return self._gone[max(likely, key=lambda k: likely[k])] if likely else None

    def _arrived(self, thing: Thing) -> _Half | None:
        """Return the most similar object that appeared, for one whose disappearance a person occluded."""
        likeness = {k: self._alike(thing, one.thing) for k, one in enumerate(self._known)}
        likely = {k: value for k, value in likeness.items() if value > 0.0 and not self._known[k].is_paired}
        return self._known[max(likely, key=lambda k: likely[k])] if likely else None

    def _alike(self, gone: Thing, come: Thing) -> float:
        config = self._config
        wait = come.span_s[1] - gone.span_s[0]
        if wait < -_SLACK_S or come.span_s[0] - gone.span_s[1] > config.pair_s:
            return 0.0
        ratios = (come.size_m2 / gone.size_m2, (come.height_m + 0.05) / (gone.height_m + 0.05))
        unlike = max(abs(math.log(ratio)) for ratio in ratios) / math.log(config.size_ratio)
        if unlike > 1.0:
            return 0.0
        apart = 0.0
        if gone.colour is not None and come.colour is not None:
            apart = _colours_apart(gone.colour, come.colour) / config.colour
        return math.exp(-unlike - apart - abs(wait) / config.pair_s) if apart < 1.0 else 0.0

    def _moved(self, gone: Thing, come: Thing, time_s: float) -> Happening:
        span = min(gone.span_s[0], come.span_s[0]), max(gone.span_s[1], come.span_s[1])
        return Happening(
            time_s=_middle(gone),
            known_s=time_s,
            change=Change.MOVED,
            object=gone.id,
            from_m=gone.place_m,
            to_m=come.place_m,
            person=self._who((gone, come), span),
        )

    def _single(self, change: Change, thing: Thing, time_s: float) -> Happening:
        place = thing.place_m
        return Happening(
            time_s=_middle(thing),
            known_s=time_s,
            change=change,
            object=thing.id,
            from_m=place if change is Change.VANISHED else None,
            to_m=place if change is Change.APPEARED else None,
            person=self._who((thing,), thing.span_s),
        )

    def _who(self, things: Sequence[Thing], span_s: tuple[float, float]) -> int | None:
        """Return the person who was nearest to an object around the time of its change."""
        near: dict[int, float] = {}
        for time_s, persons in self._people:
            if not span_s[0] - _BESIDE_S <= time_s <= span_s[1] + _BESIDE_S:
                continue
            for person in persons:
                way = min(math.dist(person.place_m, thing.place_m[:2]) for thing in things)
                near[person.id] = min(way, near.get(person.id, math.inf))
        likely = {number: way for number, way in near.items() if way < self._config.hand_m}
        return min(likely, key=lambda number: likely[number], default=None)


def _middle(thing: Thing) -> float:
    first, last = thing.span_s
    return (first + last) / 2.0 if last - first < _REMEMBERED_S else last


def _colours_apart(one: Floats, other: Floats) -> float:
    """Return the distance of two mean colours (C,), less for brightness, which shadows change."""
    apart = one - other
    brightness = float(apart.mean())
    if len(apart) == 1:
        return abs(brightness)
    return float(np.linalg.norm(apart - brightness)) + _SHADE * abs(brightness)
