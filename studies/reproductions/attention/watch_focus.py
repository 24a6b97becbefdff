"""How often the focus of attention is on the person that was learned."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.scenarios.loop.oracle_tracker import OracleTracker
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.truth.truth import PersonTruth, Truth
from peopleboy.studies.reproductions.attention.focus_choices import CHOICES
from peopleboy.tracker.attention.attend import Focus, PersonLook, learn, middle_of, search
from peopleboy.tracker.attention.attention_config import AttentionConfig
from peopleboy.tracker.attention.parts import check_box
from peopleboy.tracker.attention.sight import Sight
from peopleboy.tracker.frame import COLOUR
from peopleboy.tracker.track import Box

EVERY: Final = 10
"""Frames from one that is looked at to the next: 1.5 a second."""

FOLLOWS: Final = "follow_person"

LEARNED: Final = 0.6  # visible share from which on somebody can be learned
PRESENT: Final = 0.3  # likewise looked for

RIGHT, SECOND, WRONG = range(3)


@dataclass(frozen=True, slots=True, eq=False)
class FocusMoment:
    """One instant of a film.

    Attributes:
        time_s: [s] since its start.
        image: (H, W, 3) of the colour camera.
        truth: in that image.
    """

    time_s: float
    image: NDArray[np.uint8]
    truth: Truth


def play_focus(scenario: Scenario, seed: int, every: int = EVERY) -> Iterator[FocusMoment]:
    """Play a scenario; a robot that follows a person is told who that is."""
    if scenario.robot.behaviour != FOLLOWS:
        for number, (world, seen) in enumerate(blind_drive(scenario, seed)):
            if number % every == 0:
                yield FocusMoment(seen.time_s, seen.images[COLOUR], world.truth(COLOUR))
        return
    from peopleboy.sim.world import World  # here, as what was made before can be read without PyBullet

    config = scenario.world(seed)
    with World(config) as world:
        eyes, behaviour = OracleTracker(lambda: world.truth()), scenario.make_behaviour()
        for tick in closed_loop(world, eyes, behaviour, round(scenario.duration_s * config.control_hz)):
            if tick.frame % every == 1:
                seen = tick.observation
                yield FocusMoment(seen.time_s, seen.images[COLOUR], world.truth(COLOUR))


def wanted(scenario: Scenario, truth: Truth) -> list[PersonTruth]:
    """List those who are looked for: everybody, or the first one if the robot follows."""
    is_led = scenario.robot.behaviour == FOLLOWS
    return [person for person in truth.people if not is_led or person.id == 1]


def watch_focus(scenario: Scenario, seed: int, names: Sequence[str]) -> dict[str, Any]:
    """Play a film once, and look for everybody in it in several ways.

    A person is learned from the box in the first image that shows most of it, and not again.

    Returns:
        Plain data: by the name of each way (`CHOICES`) and the person's id how often the focus was on the
        person, how often only the second best place was, and how often neither.
    """
    counts: dict[str, dict[str, list[int]]] = {name: {} for name in names}
    looks: dict[str, dict[int, PersonLook]] = {name: {} for name in names}
    for moment in play_focus(scenario, seed):
        people = wanted(scenario, moment.truth)
        for name in names:
            _look(moment, people, CHOICES[name], looks[name], counts[name])
    return counts


def _look(
    moment: FocusMoment,
    people: Sequence[PersonTruth],
    config: AttentionConfig,
    looks: dict[int, PersonLook],
    counts: dict[str, list[int]],
) -> None:
    sight: Sight | None = None
    for person in people:
        known = looks.get(person.id)
        if known is not None and person.visible_fraction >= PRESENT:
            sight = sight or Sight.of(moment.image, config)
            found = counts.setdefault(str(person.id), [0, 0, 0])
            found[verdict(search(sight, known, config), person, moment.truth)] += 1
        elif known is None and can_be_learned(person, moment.image.shape):
            assert person.box is not None
            sight = sight or Sight.of(moment.image, config)
            looks[person.id] = learn(sight, person.box, config)


def can_be_learned(person: PersonTruth, shape: tuple[int, ...]) -> bool:
    """Tell whether most of a person is to be seen, and all of head and torso in the image."""
    if person.box is None or person.visible_fraction < LEARNED:
        return False
    try:
        check_box(person.box, shape)
    except BadInput:
        return False
    return True


def verdict(focus: Focus, person: PersonTruth, truth: Truth) -> int:
    """Tell whether the focus, or the second best place, is on the visible pixels of a person."""
    if _is_on(focus.box, person, truth):
        return RIGHT
    return SECOND if _is_on(focus.second_box, person, truth) else WRONG


def _is_on(box: Box, person: PersonTruth, truth: Truth) -> bool:
    u, v = (round(place) for place in middle_of(box))
    height, width = truth.instance.shape
    return 0 <= v < height and 0 <= u < width and int(truth.instance[v, u]) == person.id
