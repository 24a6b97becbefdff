from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pytest

from peopleboy.sim.truth.events import CONTACT_ENDS_S, Event, EventLog
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.worlds.small_worlds import box_thing, config, hall, person, pillar, robot


@dataclass
class Seen:
    """As much of a person's truth as the event log looks at."""

    name: str = "a"
    inside_fraction: float = 1.0
    hidden_by: Mapping[str, float] = field(default_factory=dict)
    posture: str = "standing"

    @property
    def visible_fraction(self) -> float:
        return self.inside_fraction - sum(share for by, share in self.hidden_by.items() if by != "border")

    def hidden_inside(self, other: str) -> float:
        return self.hidden_by[other] / self.inside_fraction


@dataclass
class Instant:
    time_s: float
    people: tuple[Seen, ...] = ()
    contacts: tuple[str, ...] = ()


def tell(*instants: Instant) -> list[tuple[str, str]]:
    log = EventLog()
    return [(event.kind, event.other) for instant in instants for event in log.update(instant)]


def hidden(*shares: float, occluder: str = "b") -> list[Instant]:
    return [
        Instant(k / 15.0, (Seen(hidden_by={occluder: share} if share else {}),))
        for k, share in enumerate(shares)
    ]


def play(world: SimulatedWorld, steps: int, command: tuple[float, float] = (0.0, 0.0)) -> list[Event]:
    log, events = EventLog(), []
    for _ in range(steps):
        events += log.update(world.truth())
        world.step(*command)
    return events


def test_a_fall_is_an_event_once_each_time_and_lying_there_from_the_start_is_none() -> None:
    postures = ("fallen", "fallen", "standing", "fallen", "fallen", "standing", "lying", "fallen")
    instants = [Instant(k / 15.0, (Seen(posture=posture),)) for k, posture in enumerate(postures)]
    log = EventLog()
    falls = [event.time_s for instant in instants for event in log.update(instant) if event.kind == "falls"]
    assert falls == [3 / 15.0, 7 / 15.0]


def test_an_occlusion_is_told_from_its_start_to_its_end() -> None:
    assert tell(*hidden(0.0, 0.1, 0.3, 0.8, 1.0, 1.0, 0.8, 0.3, 0.1, 0.0, 0.0)) == [
        ("enters view", ""),
        ("occlusion starts", "b"),
        ("total occlusion starts", "b"),
        ("total occlusion ends", "b"),
        ("occlusion ends", "b"),
    ]


def test_a_share_that_swings_about_a_threshold_is_told_once() -> None:
    about_the_start = [0.12, 0.18] * 20
    about_the_end = [0.03, 0.08] * 20
    about_the_total = [0.97, 0.99] * 20
    told = tell(*hidden(0.0, *about_the_start, *about_the_total, *about_the_start, *about_the_end))
    kinds = [kind for kind, _ in told]
    assert len(kinds) == len(set(kinds)) == 5


def test_who_is_hidden_at_once_and_seen_at_once_has_all_events_in_order() -> None:
    assert [kind for kind, _ in tell(*hidden(0.0, 1.0, 0.0))] == [
        "enters view",
        "occlusion starts",
        "total occlusion starts",
        "total occlusion ends",
        "occlusion ends",
    ]


def test_each_occluder_has_an_occlusion_of_its_own_and_a_total_one_ends_with_whom_it_started() -> None:
    shares = [
        {"seat": 0.2},
        {"seat": 0.2, "b": 0.1},
        {"b": 0.92},
        {"b": 0.4, "c": 0.6},
        {"seat": 0.2, "c": 0.1},
        {"c": 0.04},
    ]
    assert tell(*[Instant(k / 15.0, (Seen(hidden_by=by),)) for k, by in enumerate(shares)]) == [
        ("enters view", ""),
        ("occlusion starts", "seat"),
        ("occlusion starts", "b"),
        ("occlusion ends", "seat"),
        ("occlusion starts", "c"),
        ("total occlusion starts", "c"),
        ("occlusion starts", "seat"),
        ("total occlusion ends", "c"),
        ("occlusion ends", "b"),
        ("occlusion ends", "c"),
        ("occlusion ends", "seat"),
    ]


def test_whom_a_person_hides_from_the_start_is_told_before_entering_the_view() -> None:
    front = Seen(name="front")
    behind = Seen(name="behind", hidden_by={"front": 0.99, "border": 0.01}, inside_fraction=0.99)
    told = tell(Instant(0.0, (front, behind)), Instant(1.0, (front, Seen(name="behind"))))
    assert told == [
        ("enters view", ""),
        ("occlusion starts", "front"),
        ("total occlusion starts", "front"),
        ("enters view", ""),
        ("total occlusion ends", "front"),
        ("occlusion ends", "front"),
    ]


def test_shares_are_of_what_lies_inside_the_image() -> None:
    at_border = Seen(inside_fraction=0.5, hidden_by={"border": 0.5, "b": 0.1})
    assert tell(Instant(0.0, (at_border,))) == [("enters view", ""), ("occlusion starts", "b")]


def test_nobody_enters_unseen_and_who_leaves_while_hidden_is_hidden_no_more() -> None:
    unseen = Instant(0.0, (Seen(hidden_by={"wall": 1.0}),))
    assert tell(unseen) == []
    inside, gone = Instant(1.0, (Seen(),)), Instant(3.0, (Seen(inside_fraction=0.0),))
    assert tell(inside, unseen, gone, gone) == [
        ("enters view", ""),
        ("occlusion starts", "wall"),
        ("total occlusion starts", "wall"),
        ("total occlusion ends", "wall"),
        ("occlusion ends", "wall"),
        ("leaves view", ""),
    ]


def test_who_stands_at_the_image_s_border_enters_once() -> None:
    shares = [0.0, 0.03, 0.06, 0.04, 0.07, 0.03, 0.08]
    told = tell(*[Instant(k / 15.0, (Seen(inside_fraction=share),)) for k, share in enumerate(shares)])
    assert told == [("enters view", "")]


def test_who_leaves_the_world_leaves_the_view() -> None:
    assert tell(Instant(0.0, (Seen(),)), Instant(0.1)) == [("enters view", ""), ("leaves view", "")]


def test_a_bouncing_contact_is_told_once() -> None:
    touched = [(), ("wall",), (), ("wall",), ("wall",), (), (), (), (), (), (), (), ()]
    told = tell(*[Instant(k / 15.0, contacts=names) for k, names in enumerate(touched)])
    assert told == [("contact starts", "wall"), ("contact ends", "wall")]
    assert CONTACT_ENDS_S > 1.5 / 15.0


@pytest.mark.slow
@pytest.mark.parametrize("is_pillar", [True, False])
def test_a_scripted_pass_behind_something_gives_each_event_once_in_order(is_pillar: bool) -> None:
    walker = person("walker", (6.0, 4.3), (6.0, -4.3))
    broad = person("broad", (2.7, 0.0), height_m=2.0, build="stout")
    place = hall(pillar(3.0, 0.0, 1.0)) if is_pillar else hall()
    others = () if is_pillar else (broad,)
    with SimulatedWorld(config(walker, *others, place=place)) as world:
        told = [(event.kind, event.other) for event in play(world, 120) if event.person == "walker"]
    other = "pillar" if is_pillar else "broad"
    assert told == [
        ("enters view", ""),
        ("occlusion starts", other),
        ("total occlusion starts", other),
        ("total occlusion ends", other),
        ("occlusion ends", other),
        ("leaves view", ""),
    ]


@pytest.mark.slow
@pytest.mark.parametrize("gap", [0.45, 0.6, 0.9])
def test_a_pair_that_walks_abreast_gives_no_flicker(gap: float) -> None:
    pair = (
        person("left", (8.0, gap / 2.0 + 0.4), (3.0, gap / 2.0 + 0.4), (9.0, gap / 2.0)),
        person("right", (8.2, -gap / 2.0 + 0.4), (3.2, -gap / 2.0 + 0.4), (9.2, -gap / 2.0)),
    )
    with SimulatedWorld(config(*pair)) as world:
        told = [(event.kind, event.person) for event in play(world, 160, (0.0, 0.05))]
    assert max(told.count(line) for line in told) <= 2


def test_driving_into_a_wall_and_away_is_one_contact() -> None:
    block = box_thing("block", (0.4, 2.0, 1.0), (2.0, 0.0, 0.5))
    with SimulatedWorld(config(place=hall(block), robot=robot(1.2))) as world:
        log, events = EventLog(), []
        for k in range(60):
            world.step(0.5 if k < 30 else -0.5, 0.0)
            events += log.update(world.truth())
    assert [(event.kind, event.person, event.other) for event in events] == [
        ("contact starts", "robot", "block"),
        ("contact ends", "robot", "block"),
    ]
    start, end = (event.time_s for event in events)
    assert 0.8 < start < 2.0 < end
    assert np.isclose(start * 15, round(start * 15))
