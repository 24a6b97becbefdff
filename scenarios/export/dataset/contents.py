"""What a set is to hold: scenarios with many seeds, or worlds drawn at random."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.dataset.splits import SPLITS, lacking_splits, split_of
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.random_worlds.random_world import random_scenario


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """A run of a set: what is played, with which seed, and the name of its folder."""

    scenario: Scenario
    seed: int
    name: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SetContents:
    """What a set is to hold.

    Attributes:
        members: its runs, in order.
        asked: words of the command that ask for them.
        about: the same for `dataset.json`.
        lacking: which splits have no run, and what to ask for; empty if all have one.
        is_random: whether they are worlds drawn at random.
    """

    members: tuple[Member, ...]
    asked: tuple[str, ...]
    about: Mapping[str, Any]
    lacking: str
    is_random: bool = False


def of_scenarios(scenarios: Sequence[str], seeds: int) -> SetContents:
    """Hold some scenarios, by name or path, with so many seeds each, from 0 on.

    Raises:
        BadInput: a scenario cannot be played, or two have one name.
    """
    loaded = [load_scenario(scenario) for scenario in scenarios]
    names = [scenario.name for scenario in loaded]
    if len(set(names)) < len(names):
        raise BadInput(f"render: {', '.join(names)}: two scenarios have the same name; give each once")
    return SetContents(
        members=tuple(
            Member(scenario, seed, f"{scenario.name}-{seed}") for scenario in loaded for seed in range(seeds)
        ),
        asked=tuple(scenarios),
        about={"scenarios": names, "seeds": seeds},
        lacking=lacking_splits(seeds),
    )


def of_worlds(count: int, first: int) -> SetContents:
    """Hold so many worlds drawn at random, each by a seed of its own, from `first` on."""
    seeds = range(first, first + count)
    worlds = [random_scenario(seed) for seed in seeds]
    empty = [split for split in SPLITS if split not in map(split_of, seeds)]
    are = "are" if len(empty) > 1 else "is"
    return SetContents(
        members=tuple(Member(world, seed, world.name) for world, seed in zip(worlds, seeds, strict=True)),
        asked=("--randomise", str(count), "--seed", str(first)),
        about={"randomise": count, "seed": first},
        lacking=f"{' and '.join(empty)} {are} empty; give --randomise 7" if empty else "",
        is_random=True,
    )
