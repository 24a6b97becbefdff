"""The scenarios of people dressed alike: their clothes, and the total occlusions that they describe."""

from __future__ import annotations

import math

import pytest

from peopleboy.scenarios.files.library import LIBRARY
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.suite import load_suite
from peopleboy.sim.truth.events import EventLog
from peopleboy.sim.world import SimulatedWorld

Pair = tuple[str, str]  # the hidden person, and the occluder that hides most
Spans = dict[str, list[tuple[float, float]]]

OTHERS = {"carla"}  # dressed differently

SEEDS = [0, *(pytest.param(seed, marks=pytest.mark.thorough) for seed in (1, 2, 3))]
seeds = pytest.mark.parametrize("seed", SEEDS)


def total_occlusions(name: str, seed: int) -> tuple[Spans, set[Pair]]:
    """Play a world; return the spans of total occlusion by person, and pairs of person and occluder."""
    scenario = load_scenario(name)
    log, since, spans, pairs = EventLog(), dict[str, float](), Spans(), set[Pair]()
    with SimulatedWorld(scenario.world(seed)) as world:
        while world.time_s < scenario.duration_s:
            for event in log.update(world.truth()):
                if event.kind == "total occlusion starts":
                    since[event.person] = event.time_s
                    pairs.add((event.person, event.other))
                elif event.kind == "total occlusion ends":
                    spans.setdefault(event.person, []).append((since[event.person], event.time_s))
            due = [one for one in scenario.robot.commands if one.from_s <= world.time_s]
            linear, angular = (due[-1].linear_m_s, due[-1].angular_deg_s) if due else (0.0, 0.0)
            world.step(linear, math.radians(angular))
    return spans, pairs


def overlaps_s(one: list[tuple[float, float]], other: list[tuple[float, float]]) -> list[float]:
    """Return for how long each pair of spans lasts at the same time, if it does [s]."""
    both = [min(a[1], b[1]) - max(a[0], b[0]) for a in one for b in other]
    return [duration for duration in both if duration > 0.0]


def test_the_suite_holds_all_scenarios_of_people_dressed_alike() -> None:
    names = {path.stem for path in LIBRARY.glob("alike_*.yaml")}
    assert {entry.scenario for entry in load_suite("dressed_alike").runs} == names
    assert len(names) == 6


@pytest.mark.parametrize("name", sorted(path.stem for path in LIBRARY.glob("alike_*.yaml")))
def test_people_wear_the_same_clothes_with_every_seed(name: str) -> None:
    scenario = load_scenario(name)
    for seed in range(5):
        alike = [person for person in scenario.people(seed) if person.name not in OTHERS]
        assert len(alike) >= 2
        assert len({repr(person.clothes) for person in alike}) == 1
        others = [person for person in scenario.people(seed) if person.name in OTHERS]
        assert all(person.clothes != alike[0].clothes for person in others)


@pytest.mark.parametrize(
    ("name", "difference_m"), [("alike_pillar_cross", 0.0), ("alike_pillar_turn", 0.3), ("alike_swap", 0.3)]
)
def test_the_two_are_of_equal_or_of_different_height(name: str, difference_m: float) -> None:
    heights = [person.height_m for person in load_scenario(name).people(0) if person.name not in OTHERS]
    assert max(heights) - min(heights) == pytest.approx(difference_m)


@seeds
@pytest.mark.parametrize("name", ["alike_pillar_cross", "alike_pillar_turn", "alike_swap"])
def test_two_people_are_totally_occluded_at_the_same_time_twice(name: str, seed: int) -> None:
    spans, _ = total_occlusions(name, seed)
    one, other = (spans[person] for person in spans if person not in OTHERS)
    both_s = overlaps_s(one, other)
    assert len(both_s) == 2
    assert min(both_s) > 0.8


@seeds
def test_the_order_changes_behind_the_partition_both_times(seed: int) -> None:
    spans, _ = total_occlusions("alike_swap", seed)
    for arno, bruno in zip(spans["arno"], spans["bruno"], strict=True):
        assert arno[0] < bruno[0] < bruno[1] < arno[1]


@seeds
def test_all_three_are_totally_occluded_by_the_wall_between_the_doors(seed: int) -> None:
    spans, pairs = total_occlusions("alike_doors", seed)
    assert {person for person, other in pairs if other == "wall_middle"} == {"alois", "bodo", "cosmo"}
    assert all(max(end - start for start, end in spans[person]) > 3.0 for person in spans)


@seeds
def test_cupboards_hide_several_people_and_people_hide_each_other_in_groups(seed: int) -> None:
    _, behind = total_occlusions("alike_shelves", seed)
    assert len({person for person, other in behind if other.startswith("cupboard")}) >= 3
    spans, pairs = total_occlusions("alike_groups", seed)
    people = {person.name for person in load_scenario("alike_groups").people(seed)}
    assert len(spans) >= 4
    assert {other for _, other in pairs} <= people
