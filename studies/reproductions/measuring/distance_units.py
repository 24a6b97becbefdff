"""Units of work of the 2003 paper: films of people before a panoramic camera, and learning from them."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.training.distance_learning.distance_examples import Examples, collect
from peopleboy.studies.training.distance_learning.distance_trials import (
    SplitTrial,
    correlations,
    general_networks,
    general_trials,
    new_people_trials,
    personal_trials,
    position_trials,
)


@dataclass(frozen=True, slots=True)
class WalkUnit:
    """Film a scenario with the panoramic camera, and keep what is measured of whoever walks there."""

    scenario: str
    seed: int
    is_timing: bool = False

    @property
    def key(self) -> str:
        """Scenario and seed."""
        return f"walk {self.scenario}-{self.seed}"

    def run(self) -> Result:
        """Collect the examples."""
        return collect(self.scenario, self.seed)


@dataclass(frozen=True, slots=True, eq=False)
class DistanceUnit:
    """Teach the paper's networks on one film, and test them and the filter.

    Attributes:
        walk: the film.
        trial: how it is split, how often, and how networks are taught.
        examples: of the film.
    """

    walk: WalkUnit
    trial: SplitTrial
    examples: Examples
    is_timing: bool = False

    @property
    def key(self) -> str:
        """What is learned from, and how."""
        return f"distances {self.walk.key} | {_trial_key(self.trial)}"

    def run(self) -> Result:
        """Learn and test."""
        run, taught = self.examples, general_networks(self.examples, self.trial)
        found = {"general": general_trials(run, taught)}
        for (tested, whose), errors in personal_trials(run, self.trial).items():
            found[f"person {tested}, model {whose}"] = errors
        for kind, is_noisy in (("position", False), ("noisy", True)):
            for way, errors in position_trials(run, taught, is_noisy=is_noisy).items():
                found[f"{kind}, {way}"] = errors
        plain = {name: errors.plain() for name, errors in found.items()}
        return {"errors": plain, "r": correlations(run, taught).tolist()}


@dataclass(frozen=True, slots=True, eq=False)
class NewPeopleUnit:
    """Teach one network on some films, and test it on others.

    Attributes:
        scenario: of all films.
        seeds: of those that are learned from; the others are for testing.
        trial: of which only the lessons are used.
        films: examples by seed.
    """

    scenario: str
    seeds: tuple[int, ...]
    trial: SplitTrial
    films: tuple[Examples, ...]
    is_timing: bool = False

    @property
    def key(self) -> str:
        """What is learned from, and how many films there are."""
        seeds = ",".join(map(str, self.seeds))
        return f"new people {self.scenario} {seeds} of {len(self.films)} | {self.trial.lessons.epochs} epochs"

    def run(self) -> Result:
        """Learn and test."""
        taught = [film for seed, film in enumerate(self.films) if seed in self.seeds]
        others = [film for seed, film in enumerate(self.films) if seed not in self.seeds]
        return {"films": [errors.plain() for errors in new_people_trials(taught, others, self.trial.lessons)]}


def _trial_key(trial: SplitTrial) -> str:
    return f"{trial.split}, {trial.repeats} splits, {trial.lessons.epochs} epochs"
