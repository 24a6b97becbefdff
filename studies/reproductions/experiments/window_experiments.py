"""Experiments on windows that show people, and on parameters: sections 4.4.2, 4.7.4 and 4.7.8."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any, Final

import numpy as np

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.evaluations.drive_tracking import SETS
from peopleboy.studies.reproductions.evaluations.sliding_windows import (
    BY_SIZE,
    FAR_SLIDES,
    NEAR_SLIDES,
    compare_windows,
)
from peopleboy.studies.reproductions.experiment import Line, Row, Samples, as_columns, ratio
from peopleboy.studies.reproductions.plan import shortened
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.studies.training.windows import FALSE_ALARMS, VALIDATION, collect_windows, recall_at, scores_of
from peopleboy.tracker.rgbd.human_windows import WindowRange
from peopleboy.tracker.rgbd.pre_detection import HumanSize
from peopleboy.tracker.rgbd.rgbd_config import FloorFilterConfig, HypothesesConfig
from peopleboy.tracker.rgbd.u_depth import UDepthConfig
from peopleboy.tracker.rgbd.window_model import people_detector, shipped_windows

OWN, COLOUR, OPENCV = "own machine", "own machine, colour alone", "OpenCV's detector"
NEAR, FAR = str(WindowRange.NEAR), str(WindowRange.FAR)
MODELS: Final = ((FAR, OWN), (FAR, COLOUR), (FAR, OPENCV), (NEAR, OWN), (NEAR, COLOUR))
"""Ranges, and who judges windows there."""
BOTH: Final = f"{NEAR}+{FAR} {BY_SIZE}"
_SLID: Final = (6, 7, 11)  # numbers of the sets whose images are searched


def loop_times(using: Measurement) -> Samples:
    """Time a frame without pre-detection and with it [ms] (table 4.2)."""
    found = _slid(using)
    rest = found["parts"]["hypotheses and filters"]
    slid, by_size = found["far 8 px, scale 1.10"]["ms"], found[BOTH]["ms"]
    times = {
        "detection by sliding windows": slid,
        "detection by size": by_size,
        "hypotheses and filters": rest,
        "all, sliding windows": slid + rest,
        "all, by size": by_size + rest,
    }
    return {Line(name, OWN): as_columns([{"ms": ms}]) for name, ms in times.items()}


def sliding_windows(using: Measurement, *, window: str) -> Samples:
    """Measure times and rates of near or far windows slid over whole images (tables 4.3 and 4.4)."""
    found = _slid(using)
    rows = {
        Line(one.name, OPENCV if one.is_opencv else OWN): found[one.key]
        for one in (FAR_SLIDES if window == FAR else NEAR_SLIDES)
    }
    rows[Line(BY_SIZE, OWN)] = found[f"{window} {BY_SIZE}"]
    return {line: as_columns([_tallied(tally)]) for line, tally in rows.items()}


def windows_by_size(using: Measurement) -> Samples:
    """Measure times and rate of windows on what has a person's size (table 4.5)."""
    found = _slid(using)
    parts = {name: {"ms": found["parts"][name]} for name in ("pre-detection", "verification")}
    rows = {**parts, "total": _tallied(found[BOTH])}
    return {Line(name, OWN): as_columns([row]) for name, row in rows.items()}


def parameters(using: Measurement) -> Samples:  # noqa: ARG001
    """Count the settings that must be chosen, switches left out (table 4.7)."""
    counts = {
        "pre-detection": _numbers(HumanSize) + _numbers(UDepthConfig),
        "classification": 2,  # a score for either range
        "hypotheses": _numbers(HypothesesConfig),
        "tracking": _numbers(FloorFilterConfig),
    }
    counts["sum"] = sum(counts.values())
    return {Line(name, "default"): as_columns([{"parameters": count}]) for name, count in counts.items()}


def window_models(using: Measurement) -> Samples:
    """Measure recall and false alarms of window classifiers in places that none learned from."""
    runs = [(name, seed) for name, count in VALIDATION.items() if name for seed in range(count)]
    runs = runs[:1] if using.plan.is_quick else runs
    scores = using.results(Unit(f"windows {name}-{seed}", score_windows, (name, seed)) for name, seed in runs)
    return {
        Line(f"{kind} windows", model): as_columns([_judged([one[f"{kind} {model}"] for one in scores])])
        for kind, model in MODELS
    }


def _judged(scores: Sequence[Mapping[str, Sequence[float]]]) -> Row:
    people, others = (np.concatenate([one[kind] for one in scores]) for kind in ("people", "others"))
    together = np.concatenate([people, others])
    return {
        "people": len(people),
        "others": len(others),
        "recall at 1 % false": recall_at(together, np.arange(len(together)) < len(people), FALSE_ALARMS),
        "recall at 0": float(np.mean(people > 0.0)),
        "false at 0": float(np.mean(others > 0.0)),
    }


def _slid(using: Measurement) -> Result:
    """Search the same images in all ways; times are exact only where a unit runs alone."""
    plan = using.plan
    names, every = tuple(SETS[n - 1] for n in plan.sets if n in _SLID), 30 if plan.is_quick else 10
    key = f"slide {', '.join(names)} {plan.drive_s:g}s every {every}"
    (found,) = using.results([Unit(key, slide_windows, (names, plan.drive_s, every), is_timing=True)])
    return found


def _tallied(plain: Mapping[str, Any]) -> Row:
    return {
        "ms": plain["ms"],
        "rate": ratio(plain["found"], plain["people"]),
        "FP": plain["false"],
        "FP per image": plain["false"] / plain["images"],
        "images": plain["images"],
    }


def _numbers(config: type[Any]) -> int:
    return sum(str(field.type) != "bool" for field in fields(config))


def slide_windows(scenarios: Sequence[str], most_s: float, every: int) -> Result:
    """Look for people in every so-manieth image by sliding windows, and by their size in depth."""
    return compare_windows([(shortened(name, most_s), 0) for name in scenarios], every)


def score_windows(scenario: str, seed: int) -> Result:
    """Collect windows of a scenario, and give the scores of people and others by range and classifier."""
    samples = collect_windows(scenario, seed, has_jitter=False)
    models = {
        OWN: shipped_windows(sees_depth=True),
        COLOUR: shipped_windows(sees_depth=False),
        OPENCV: people_detector(),
    }
    result: Result = {}
    for kind, name in MODELS:
        scores = scores_of(models[name], samples, WindowRange(kind)).round(3)
        is_person = samples.is_person(WindowRange(kind))
        people, others = scores[is_person].tolist(), scores[~is_person].tolist()
        result[f"{kind} {name}"] = {"people": people, "others": others}
    return result
