"""Chapter 3 of the thesis on situation awareness: what stands, and what was moved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from peopleboy.studies.reproductions.evaluations.scene_scores import (
    ADAPT,
    CHAIRS,
    MEAN,
    OURS,
    PRESETS,
    PRINTED,
    ROBUST,
    SEQUENCES,
)
from peopleboy.studies.reproductions.experiments.drives import Row, columns
from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.scene_units import SceneUnit
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.studies.reproductions.pictures.canvas import png_address
from peopleboy.studies.reproductions.pictures.situation_figures import draw_maps

TOF: Final = PRESETS[0]
ALL: Final = "all"
_SHOWN: Final = ("s1r1", "s2r1", "s3r1", "s4r1", "s5r1", "s6r1")
_WITH_ADAPT: Final = (MEAN, ADAPT, *OURS)


@dataclass(frozen=True, slots=True)
class StaticScenes:
    """Distance of the static scene from the truth, sequence by sequence: table 3.1."""

    id: str = "situation-table-3.1"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Every film, by time of flight."""
        return missing(_films(plan, TOF), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give mean and deviation of each sequence, and the mean of all sequences, one for each seed."""
        groups = {name: (name,) for name in plan.scenes} | {ALL: plan.scenes}
        return {
            Line(group, who): columns(
                _static([done[_film(plan, TOF, name, seed).key][who] for name in names])
                for seed in range(plan.scene_seeds)
            )
            for group, names in groups.items()
            for who in (*PRINTED, ROBUST)
        }


@dataclass(frozen=True, slots=True)
class Watched:
    """Background, things, people and happenings by depth camera, of all sequences together."""

    id: str = "situation-scene-models"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Every film, by every depth camera."""
        return missing([film for preset in plan.presets for film in _films(plan, preset)], done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the figures of each camera, chairs by themselves, one for each seed."""
        found: dict[Line, Any] = {}
        for preset in plan.presets:
            chairs = tuple(name for name in plan.scenes if name in CHAIRS)
            others = tuple(name for name in plan.scenes if name not in CHAIRS)
            for group, names in ((preset, others), (f"{preset}, chairs", chairs)):
                for who in (ADAPT, *OURS) if names else ():
                    found[Line(group, who)] = columns(
                        _watched([done[_film(plan, preset, name, seed).key] for name in names], who)
                        for seed in range(plan.scene_seeds)
                    )
        return found


@dataclass(frozen=True, slots=True)
class Maps:
    """Backgrounds of one sequence of each kind: figures 3.8 to 3.13."""

    id: str = "situation-figures-3.8-3.13"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Films of the first seed, by time of flight."""
        return missing([_film(plan, TOF, name, 0) for name in plan.scenes if name in _SHOWN], done)

    def samples(self, plan: Plan, done: Done) -> Samples:  # noqa: ARG002
        """Give nothing: the figures have no numbers."""
        return {}

    def picture(self, plan: Plan, done: Done) -> str | None:
        """Draw them; None where a plan leaves out all of them."""
        maps = {name: done[_film(plan, TOF, name, 0).key]["maps"] for name in plan.scenes if name in _SHOWN}
        return png_address(draw_maps(maps)) if maps else None


def _films(plan: Plan, preset: str) -> list[SceneUnit]:
    return [_film(plan, preset, name, seed) for name in plan.scenes for seed in range(plan.scene_seeds)]


def _film(plan: Plan, preset: str, name: str, seed: int) -> SceneUnit:  # noqa: ARG001
    """By time of flight all models watch; by the others those that are worth it."""
    is_tof = preset == TOF
    return SceneUnit(
        scenario=SEQUENCES[name],
        seed=seed,
        preset=preset,
        names=(*PRINTED, *OURS) if is_tof else _WITH_ADAPT,
        keeps_maps=is_tof and seed == 0 and name in _SHOWN,
    )


def _static(films: Sequence[Mapping[str, Any]]) -> Row:
    return {
        "mean [mm]": _mean([film["clean"]["mean"] for film in films]),
        "deviation [mm]": _mean([film["clean"]["deviation"] for film in films]),
    }


def _watched(films: Sequence[Mapping[str, Any]], who: str) -> Row:
    """Give the figures of a model; what is counted is counted in all films together."""
    own = [film[who] for film in films]
    events = {name: sum(film["events"][name] for film in own) for name in own[0]["events"]}
    people, things = (np.sum([film[kind] for film in own], axis=0) for kind in ("people", "things"))
    precision = _share(events["right"], events["right"] + events["false"])
    recall = _share(events["told"], events["events"])
    return {
        "mean [mm]": _mean([film["ever"]["mean"] for film in own]),
        "median pixel [mm]": _mean([film["ever"]["median"] for film in own]),
        "known": _mean([film["ever"]["known"] for film in own]),
        "better than MEAN": _mean(
            [film[who]["clean"]["mean"] < film[MEAN]["clean"]["mean"] for film in films]
        ),
        "events F1": _share(2.0 * precision * recall, precision + recall),
        "moved by": _share(events["named"], events["asked"]),
        "things P": _share(things[0], things[0] + things[1]),
        "things R": _share(things[0], things[0] + things[2]),
        "people P": _share(people[0], people[0] + people[1]),
        "people R": _share(people[0], people[0] + people[2]),
        "ms": _mean([film["ms"] for film in own]),
    }


def _share(part: float, whole: float) -> float:
    return float(part / whole) if whole else float("nan")


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values))


SCENES = (StaticScenes(), Watched(), Maps())
"""Experiments of section 3.7 of that thesis."""
