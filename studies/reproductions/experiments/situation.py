"""Experiments of the thesis on situation awareness on scenes (chapter 3) and attention (chapter 5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.evaluations import attention_focus as attention
from peopleboy.studies.reproductions.evaluations import scene_scores as scenes
from peopleboy.studies.reproductions.experiment import Floats, Line, Row, Samples, as_columns, ratio
from peopleboy.studies.reproductions.pictures.situation_figures import draw_maps
from peopleboy.studies.reproductions.plan import Plan, shortened
from peopleboy.studies.reproductions.units import Measurement, Unit

TOF: Final = scenes.PRESETS[0]
ALL: Final = "all"
_SHOWN: Final = ("s1r1", "s2r1", "s3r1", "s4r1", "s5r1", "s6r1")

FOCUS_SCENARIOS: Final = ("crossing_3", "same_uniform", "crowd_8", "follow_passers_by")
FOCUS_SETS: Final = {"A": ("follow_passers_by",), "B": ("same_uniform", "crowd_8")}
"""Scenarios for the thesis's sets: a person who leads the robot past others; people dressed alike."""
COMPARED: Final = (attention.PRINTED_NAME, attention.MATCHING, attention.DEFAULT)
TRACKERS: Final = ("contour", "attentive-printed", "attentive")
FOLLOWERS: Final = ("attentive", "contour")
ABSENCES: Final = ("absence_10s", "absence_60s")
FOLLOWED: Final = "follow_absence"
_IN_TIME_S: Final = 1.0


def static_scenes(using: Measurement) -> Samples:
    """Measure how far each model's static scene is from the truth, sequence by sequence (table 3.1)."""
    plan = using.plan
    seeds, found = range(plan.scene_seeds), _scenes(using, (TOF,))
    groups = {name: (name,) for name in plan.scenes} | {ALL: plan.scenes}
    return {
        Line(group, model): as_columns(
            {
                f"{kind} [mm]": _mean([found[TOF, name, seed][model]["clean"][kind] for name in names])
                for kind in ("mean", "deviation")
            }
            for seed in seeds
        )
        for group, names in groups.items()
        for model in (*scenes.PRINTED, scenes.ROBUST)
    }


def scene_models(using: Measurement) -> Samples:
    """Score background, objects, people and events by depth camera, chairs by themselves."""
    plan, result = using.plan, {}
    found = _scenes(using, plan.presets)
    others, chairs = (
        [name for name in plan.scenes if (name in scenes.CHAIRS) == is_chair] for is_chair in (False, True)
    )
    for preset in plan.presets:
        for group, names in ((preset, others), (f"{preset}, chairs", chairs)):
            for model in (scenes.ADAPT, *scenes.OURS) if names else ():
                result[Line(group, model)] = as_columns(
                    _scene_scores([found[preset, name, seed] for name in names], model)
                    for seed in range(plan.scene_seeds)
                )
    return result


def _scene_scores(runs: Sequence[Result], model: str) -> Row:
    """Return a model's scores; what is counted is counted in all runs together."""
    own = [run[model] for run in runs]
    events = {name: sum(run["events"][name] for run in own) for name in own[0]["events"]}
    people, things = (np.sum([run[kind] for run in own], axis=0) for kind in ("people", "things"))
    precision = ratio(events["right"], events["right"] + events["false"])
    recall = ratio(events["told"], events["events"])
    return {
        "mean [mm]": _mean([run["ever"]["mean"] for run in own]),
        "median pixel [mm]": _mean([run["ever"]["median"] for run in own]),
        "known": _mean([run["ever"]["known"] for run in own]),
        "better than MEAN": _mean(
            [run[model]["clean"]["mean"] < run[scenes.MEAN]["clean"]["mean"] for run in runs]
        ),
        "events F1": ratio(2.0 * precision * recall, precision + recall),
        "moved by": ratio(events["named"], events["asked"]),
        "things P": ratio(things[0], things[0] + things[1]),
        "things R": ratio(things[0], things[0] + things[2]),
        "people P": ratio(people[0], people[0] + people[1]),
        "people R": ratio(people[0], people[0] + people[2]),
        "ms": _mean([run["ms"] for run in own]),
    }


def scene_maps(using: Measurement) -> Figure | None:
    """Draw backgrounds of a sequence of each kind (figures 3.8 to 3.13); None where a plan leaves all out."""
    names = [name for name in using.plan.scenes if name in _SHOWN]
    runs = using.results(_scene_unit(TOF, name, 0) for name in names)
    return draw_maps({name: run["maps"] for name, run in zip(names, runs, strict=True)}) if runs else None


def _scenes(using: Measurement, presets: Sequence[str]) -> dict[tuple[str, str, int], Result]:
    """Return what all models gave, by depth camera, sequence and seed."""
    plan = using.plan
    keys = [
        (preset, name, seed) for preset in presets for name in plan.scenes for seed in range(plan.scene_seeds)
    ]
    return dict(zip(keys, using.results(_scene_unit(*key) for key in keys), strict=True))


def _scene_unit(preset: str, name: str, seed: int) -> Unit:
    """Play a run once; by time of flight all models watch it, by other cameras those that are worth it."""
    names = (*scenes.PRINTED, *scenes.OURS) if preset == TOF else (scenes.MEAN, scenes.ADAPT, *scenes.OURS)
    keeps_maps = preset == TOF and seed == 0 and name in _SHOWN
    scenario = scenes.SEQUENCES[name]
    key = f"scene {scenario}-{seed} {preset}{' with maps' if keeps_maps else ''} | {', '.join(names)}"
    return Unit(key, score_scene, (scenario, seed, preset, names, keeps_maps))


def score_scene(scenario: str, seed: int, preset: str, names: Sequence[str], keeps_maps: bool) -> Result:
    """Play a scenario before a depth camera, and score scene scenes."""
    played = scenes.with_preset(load_scenario(scenario), preset)
    return scenes.watch_scene(played, seed, names, keeps_maps=keeps_maps)


def focus(using: Measurement) -> Samples:
    """Measure how often the focus is on the learned person, a video being one person of one run (5.1)."""
    found = _focused(using)
    return {
        Line(group, name): _focus_shares(
            np.array(
                [
                    counts
                    for scenario in scenarios
                    for run in found[scenario]
                    for counts in run[name].values()
                ],
                dtype=np.float64,
            ).reshape(-1, 3)
        )
        for group, scenarios in FOCUS_SETS.items()
        for name in COMPARED
    }


def _focus_shares(videos: Floats) -> dict[str, Floats]:
    """Return shares of all images together, and means of videos (V, 3), also with the second best place."""
    right, second = videos[:, 0], videos[:, :2].sum(axis=1)
    whole = videos.sum(axis=1)
    return as_columns(
        [
            {
                "pooled": right.sum() / whole.sum(),
                "per video": float(np.mean(right / whole)),
                "pooled, first two": second.sum() / whole.sum(),
                "per video, first two": float(np.mean(second / whole)),
                "images": whole.sum(),
            }
        ]
    )


def focus_variants(using: Measurement) -> Samples:
    """Measure the share of right focus with each reading of chapter 5, by scenario, one value a seed."""
    found = _focused(using)
    return {
        Line(name, "measured"): {
            scenario: np.array([_right(run[name]) for run in runs]) for scenario, runs in found.items()
        }
        for name in attention.CHOICES
    }


def _right(people: Mapping[str, Sequence[int]]) -> float:
    counts = np.array(list(people.values()), dtype=np.float64).reshape(-1, 3)
    return ratio(counts[:, 0].sum(), counts.sum())


def _focused(using: Measurement) -> dict[str, list[Result]]:
    """Return the runs of each scenario, in which all variants of attention look for its people."""
    return using.grouped({name: _focus_units(using.plan, name) for name in FOCUS_SCENARIOS})


def _focus_units(plan: Plan, scenario: str) -> list[Unit]:
    variants = tuple(attention.CHOICES)
    return [
        Unit(
            f"focus {scenario}-{seed} {plan.drive_s:g}s | {', '.join(variants)}",
            score_focus,
            (scenario, seed, variants, plan.drive_s),
        )
        for seed in range(plan.drives)
    ]


def score_focus(scenario: str, seed: int, variants: Sequence[str], most_s: float) -> Result:
    """Play a scenario, and direct attention to its people."""
    return attention.watch_focus(shortened(scenario, most_s), seed, variants)


def absences(using: Measurement) -> Samples:
    """Measure who is recognised after an absence, and who is taken for that person meanwhile, by seed."""
    names = ", ".join(TRACKERS)
    units = {
        scenario: [
            Unit(f"absence {scenario}-{seed} | {names}", score_absence, (scenario, seed, TRACKERS))
            for seed in range(using.plan.absences)
        ]
        for scenario in (ABSENCES[:1] if using.plan.is_quick else ABSENCES)
    }
    return {
        Line(scenario, name): _recognised([run[name] for run in runs])
        for scenario, runs in using.grouped(units).items()
        for name in TRACKERS
    }


def _recognised(runs: Sequence[Mapping[str, Any]]) -> dict[str, Floats]:
    late, found = (np.array([one[key] for one in runs], np.float64) for key in ("late_s", "found_s"))
    return {
        "right in time": (late <= _IN_TIME_S).astype(np.float64),
        "right at all": np.isfinite(late).astype(np.float64),
        "found in time": (found <= _IN_TIME_S).astype(np.float64),
        "late [s]": late,
        "accepted while away": np.array([ratio(one["accepted"], one["away"]) for one in runs]),
    }


def score_absence(scenario: str, seed: int, trackers: Sequence[str]) -> Result:
    """Play a scenario in which a person goes away and comes back, for several trackers."""
    return attention.watch_absence(load_scenario(scenario), seed, trackers)


def followers(using: Measurement) -> Samples:
    """Measure whether a robot goes on with the person who was away, by seed."""
    units = {
        name: [
            Unit(f"follow {FOLLOWED}-{seed} | {name}", score_follower, (FOLLOWED, seed, name))
            for seed in range(using.plan.follows)
        ]
        for name in FOLLOWERS
    }
    return {
        Line(FOLLOWED, name): as_columns(
            {
                "resumed": ratio(one["resumed"], one["absences"]),
                "right": one["right"] / one["images"],
                "wrong": one["wrong"] / one["images"],
            }
            for one in runs
        )
        for name, runs in using.grouped(units).items()
    }


def score_follower(scenario: str, seed: int, tracker: str) -> Result:
    """Let a robot follow a person who goes away twice."""
    return attention.watch_follower(load_scenario(scenario), seed, tracker)


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values))
