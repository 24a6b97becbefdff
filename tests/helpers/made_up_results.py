"""Invented results of all units, and values of all experiments."""

from __future__ import annotations

import base64
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.experiment import Experiment, Line, Samples
from peopleboy.studies.reproductions.experiments.attention import CHOICES as WAYS
from peopleboy.studies.reproductions.experiments.attention import TRACKERS
from peopleboy.studies.reproductions.experiments.drive_tracking import CHOICES
from peopleboy.studies.reproductions.experiments.panoramic_room import CUES
from peopleboy.studies.reproductions.experiments.scenes import CLEAN, OURS, PRINTED, TRUE_PEOPLE
from peopleboy.studies.reproductions.experiments.sliding_windows import (
    BY_SIZE,
    FAR_SLIDES,
    MODELS,
    NEAR_SLIDES,
    PARTS,
)
from peopleboy.studies.reproductions.experiments.tracking import METRICS, TrackerTrial, trials
from peopleboy.studies.reproductions.image_errors import ImageErrors
from peopleboy.studies.reproductions.plan import Plan
from peopleboy.studies.reproductions.units import Measurement

DRIVES = Plan(cache=Path("films"), drives=2)


ERRORS = {"mean": 9.0, "deviation": 30.0, "median": 1.0, "known": 0.99}


EVENTS = {"right": 3, "false": 1, "events": 3, "told": 2, "asked": 2, "named": 1}


COUNTS = {"people": [9, 1, 1], "things": [8, 1, 2], "events": EVENTS}


SCENE = {"clean": ERRORS, "ever": ERRORS, "ms": 5.0} | COUNTS


MAP = base64.b64encode(cv2.imencode(".png", np.full((8, 10), 3000, np.uint16))[1].tobytes()).decode()


class MadeUp(dict[str, Result]):
    """Results of drives, windows, runs and times, all of them invented."""

    def __contains__(self, key: object) -> bool:
        return True

    def spent_s(self, key: str) -> float:
        """Give no time at all."""
        del key
        return 0.0

    def __missing__(self, key: str) -> Result:
        if key.startswith("score_windows "):
            return {f"{kind} {who}": {"people": [1.0, 2.0], "others": [-1.0]} for kind, who in MODELS}
        if key.startswith("watch_scene "):
            models = (*PRINTED, TRUE_PEOPLE, *OURS)
            return dict.fromkeys(models, SCENE) | {"maps": dict.fromkeys((*models, CLEAN), MAP)}
        if key.startswith("compare_windows "):
            tally = {"ms": 10.0, "images": 3, "people": 4, "found": 3, "false": 5}
            kinds = (f"{one} {BY_SIZE}" for one in ("near+far", "far", "near"))
            slides = (how.key for how in (*FAR_SLIDES, *NEAR_SLIDES))
            return dict.fromkeys((*slides, *kinds), tally) | {"parts": dict.fromkeys(PARTS, 3.0)}
        if key.startswith("watch_focus "):
            return {name: {"1": [6, 2, 2], "2": [9, 0, 1]} for name in WAYS}
        if key.startswith("watch_absence "):
            return {name: {"away": 50, "accepted": 1, "late_s": 0.5, "found_s": 0.4} for name in TRACKERS}
        if key.startswith("watch_follower "):
            return {"images": 90, "right": 30, "wrong": 1, "absences": 2, "resumed": 2}
        if key.startswith("time "):
            return {"maps": 6.0, "maps, patterns and their sums": 12.0}
        if key.startswith("picture "):
            return {"picture": "data:image/png;base64,"}
        truth = [[1, 1, 2.0, 0.5, 2.0, 0.0, 1], [2, 1, 4.0, 0.5, 4.0, 0.0, 1], [3, 1, 6.0, 0.5, 6.0, 0.0, 1]]
        told = [[frame, 1, x, y + 0.1] for frame, _, x, y, *_ in truth]
        hits = [[frame, 1, 1, 0.0, 0.1, 0.0, 0.1] for frame, *_ in truth]
        pre = {"bands": [[3, 3], [2, 1], [2, 1], [2, 0]], "false": 1}
        seen = {
            "frames": 3,
            "hits": hits,
            "missed": [[3, 2]],
            "false": [],
            "ms": 9.0,
            "pre": pre,
            "tracks": told,
        }
        robot = [[0.1 * frame, 0.0, 0.0] for frame in range(3)]
        return dict.fromkeys(CHOICES, seen) | {"truth": truth, "robot": robot, "depth": told, "legs": told}


def made_up(experiment: Experiment) -> Samples:
    """Invent values for every line that an experiment has in the source or in its declaration."""
    rng = np.random.default_rng(0)
    if experiment.id == "panoramic-figure-5":
        return {Line(cue, "room_long"): {"|r|": rng.uniform(0.5, 0.9, 3)} for cue in CUES}
    if experiment.id.startswith("situation-"):
        return experiment.measure(Measurement(DRIVES, MadeUp())) if experiment.measure else {}
    declared = declaration(experiment)
    if declared.get("kind") == "distances":
        return {Line(group, "room_long, random split"): {"m": errors(rng)} for group in experiment.groups}
    if declared.get("kind") == "tracking":
        names = METRICS.get(str(declared["metrics"])) or declared["metrics"]
        return {one.line: {m: rng.uniform(50, 90, 3) for m in names} for one in trials_of(experiment)}
    return {
        Line(one.group, "default"): {m: rng.uniform(50, 90, 3) for m in one.values}
        for one in experiment.values
    }


def declaration(experiment: Experiment) -> dict[str, Any]:
    """Give what the source's file says of how an experiment is measured."""
    if not isinstance(experiment.measure, partial):
        return {}
    return {"kind": experiment.measure.func.__name__, **experiment.measure.keywords}


def trials_of(experiment: Experiment) -> list[TrackerTrial]:
    """List all lines of an experiment in which trackers see data sets."""
    declared = declaration(experiment)
    own = {name: one for name, one in declared.items() if name not in ("kind", "metrics")}
    return list(trials(is_quick=False, **own))


def errors(rng: np.random.Generator) -> ImageErrors:
    """Invent two splits of a film of 400 images."""
    rows = [np.sort(rng.permutation(400)[:280]) for _ in range(2)]
    return ImageErrors.of([(part, rng.exponential(0.1, 280)) for part in rows], 400)
