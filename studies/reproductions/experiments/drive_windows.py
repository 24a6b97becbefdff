"""Tables of the thesis on situation awareness about windows that show people, and about parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Final

import numpy as np

from peopleboy.studies.reproductions.evaluations.drive_tracking import SETS
from peopleboy.studies.reproductions.evaluations.sliding_windows import (
    BY_SIZE,
    FAR_SLIDES,
    NEAR_SLIDES,
    Slide,
)
from peopleboy.studies.reproductions.experiments.drives import Row, columns
from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.window_units import (
    FAR,
    MACHINES,
    NEAR,
    OPENCV,
    OWN,
    SlideUnit,
    WindowUnit,
)
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.studies.training.window_learning.teach_windows import FALSE_ALARMS, recall_at
from peopleboy.studies.training.window_learning.window_lesson import TESTS
from peopleboy.tracker.rgbd.pre_detection import HumanSize
from peopleboy.tracker.rgbd.rgbd_config import FloorFilterConfig, HypothesesConfig
from peopleboy.tracker.rgbd.u_depth import UDepthConfig

_SLID: Final = (6, 7, 11)  # numbers of the sets whose images are searched
_SWITCHED: Final = "bool"


@dataclass(frozen=True, slots=True)
class Sliding:
    """Times and rates of windows slid over whole images: tables 4.3 and 4.4."""

    id: str
    slides: tuple[Slide, ...]
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """The images."""
        return missing([_slid(plan)], done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the figures of each shift and scale."""
        found = done[_slid(plan).key]
        rows = {
            Line(one.name, OPENCV if one.is_opencv else OWN): columns([_tallied(found[one.key])])
            for one in self.slides
        }
        kind = str(self.slides[0].kind)
        return rows | {Line(BY_SIZE, OWN): columns([_tallied(found[f"{kind} {BY_SIZE}"])])}


@dataclass(frozen=True, slots=True)
class BySize:
    """Times and rates of windows on what has a human's size: table 4.5."""

    id: str = "situation-table-4.5"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """The images."""
        return missing([_slid(plan)], done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the times of the parts, and the rate of both."""
        found = done[_slid(plan).key]
        parts: Mapping[str, float] = found["parts"]
        rows = {Line(name, OWN): columns([{"ms": parts[name]}]) for name in ("pre-detection", "verification")}
        return rows | {Line("total", OWN): columns([_tallied(found[f"{NEAR}+{FAR} {BY_SIZE}"])])}


@dataclass(frozen=True, slots=True)
class LoopTimes:
    """What a frame costs without pre-detection and with it: table 4.2."""

    id: str = "situation-table-4.2"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """The images."""
        return missing([_slid(plan)], done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give milliseconds."""
        found = done[_slid(plan).key]
        rest = found["parts"]["hypotheses and filters"]
        slid = found["far 8 px, scale 1.10"]["ms"]
        by_size = found[f"{NEAR}+{FAR} {BY_SIZE}"]["ms"]
        times = {
            "detection by sliding windows": slid,
            "detection by size": by_size,
            "hypotheses and filters": rest,
            "all, sliding windows": slid + rest,
            "all, by size": by_size + rest,
        }
        return {Line(name, OWN): columns([{"ms": ms}]) for name, ms in times.items()}


@dataclass(frozen=True, slots=True)
class Parameters:
    """How many numbers must be chosen: table 4.7."""

    id: str = "situation-table-4.7"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:  # noqa: ARG002
        """Nothing: they are counted."""
        return []

    def samples(self, plan: Plan, done: Done) -> Samples:  # noqa: ARG002
        """Give the number of settings, switches left out."""
        counts = {
            "pre-detection": _numbers(HumanSize) + _numbers(UDepthConfig),
            "classification": 2,  # a score for either range
            "hypotheses": _numbers(HypothesesConfig),
            "tracking": _numbers(FloorFilterConfig),
        }
        counts["sum"] = sum(counts.values())
        return {Line(name, "default"): columns([{"parameters": count}]) for name, count in counts.items()}


@dataclass(frozen=True, slots=True)
class Machines:
    """How well machines tell people by their windows in places that nobody learned from."""

    id: str = "situation-windows"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Windows of library scenarios."""
        return missing(self._units(plan), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give recall and false alarms of all windows together."""
        return {
            Line(f"{kind} windows", who): columns([self._judged(plan, done, f"{kind} {who}")])
            for kind, who in MACHINES
        }

    def _judged(self, plan: Plan, done: Done, key: str) -> Row:
        people, others = (
            np.concatenate([done[unit.key][key][which] for unit in self._units(plan)])
            for which in ("people", "others")
        )
        scores = np.concatenate([people, others])
        is_person = np.arange(len(scores)) < len(people)
        return {
            "people": len(people),
            "others": len(others),
            "recall at 1 % false": recall_at(scores, is_person, FALSE_ALARMS),
            "recall at 0": float(np.mean(people > 0.0)),
            "false at 0": float(np.mean(others > 0.0)),
        }

    def _units(self, plan: Plan) -> list[WindowUnit]:
        films = [(name, seed) for name, count in TESTS.items() if name for seed in range(count)]
        return [WindowUnit(name, seed) for name, seed in (films[:1] if plan.is_quick else films)]


def _slid(plan: Plan) -> SlideUnit:
    names = tuple(SETS[number - 1] for number in plan.sets if number in _SLID)
    return SlideUnit(names, plan.drive_s, 30 if plan.is_quick else 10)


def _tallied(plain: Mapping[str, Any]) -> Row:
    rate = plain["found"] / plain["people"] if plain["people"] else float("nan")
    return {
        "ms": plain["ms"],
        "rate": rate,
        "FP": plain["false"],
        "FP per image": plain["false"] / plain["images"],
        "images": plain["images"],
    }


def _numbers(config: type[Any]) -> int:
    return sum(str(field.type) != _SWITCHED for field in fields(config))


WINDOWS = (
    LoopTimes(),
    Sliding("situation-table-4.3", FAR_SLIDES),
    Sliding("situation-table-4.4", NEAR_SLIDES),
    BySize(),
    Parameters(),
    Machines(),
)
"""Experiments of sections 4.4.2, 4.7.4 and 4.7.8 of that thesis."""
