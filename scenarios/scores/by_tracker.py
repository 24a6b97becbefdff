"""Group scored runs by tracker, check that they show the same scenes, and compare trackers pair by pair."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.run_folder.finished_run import read_run
from peopleboy.scenarios.scores.bootstrap import PairedDifference, compare_pairs, none_for_nan
from peopleboy.scenarios.scores.comfort_metrics import ComfortScore
from peopleboy.scenarios.scores.evaluate_runs import BoxReference, ScoreOptions, evaluate_runs
from peopleboy.scenarios.scores.summaries import summarise
from peopleboy.tracker.evaluation.evaluate import Scores, combine
from peopleboy.tracker.evaluation.table import FIGURES, Figure, to_json
from peopleboy.user_files import read_json

Scene = tuple[str, int]
"""Scenario, or footage, and seed."""

_BESIDE: Final = ("drawn", "description", "physics")  # no part of the scene, or options of `run`
_OF_ROBOT: Final = ("tracker", "behaviour", "cameras")  # likewise; only cameras mounted for a tracker


def check_same_scenes(sides: Sequence[Mapping[Path, Scene | None]]) -> None:
    """Check that runs with the same scenario name and seed show the same scene.

    Args:
        sides: the groups that are compared: folders of runs, with the scene from their run.json.

    Raises:
        BadInput: scenarios of the same name and seed differ in more than tracker and behaviour.
    """
    first: dict[Scene, tuple[int, Path]] = {}
    for side, runs in enumerate(sides):
        for folder, scene in runs.items():
            if scene is None:
                continue
            home, other = first.setdefault(scene, (side, folder))
            if home != side and (change := _change(other, folder)):
                raise BadInput(
                    f"{folder}: {scene[0]}, seed {scene[1]}, differs from {other}: {change}; run both "
                    "again, or rename one of the scenarios"
                )


def _change(one: Path, other: Path) -> str:
    """Describe the first difference between the scenes of two runs; empty without one or if unknown."""
    paths = one / "scenario.yaml", other / "scenario.yaml"
    if not all(path.is_file() for path in paths) or paths[0].read_bytes() == paths[1].read_bytes():
        return ""
    before, after = map(_scene, paths)
    return next(_changes(before, after, ""), "") if before and after else ""


def _scene(path: Path) -> Mapping[str, Any]:
    """Read the scene of a scenario file, with the robot's own cameras; empty for an unreadable file."""
    try:
        data = read_yaml(path)
    except BadInput:  # reported when the scene is replayed
        return {}
    if "place" not in data:
        return {}
    robot = said if isinstance(said := data.get("robot"), dict) else {}
    mounted = read_run(path.parent).get("mounted_for_tracker", ())
    cameras = {name: said for name, said in robot.get("cameras", {}).items() if name not in mounted}
    kept = {key: said for key, said in robot.items() if key not in _OF_ROBOT}
    return {key: said for key, said in data.items() if key not in _BESIDE} | {
        "robot": kept | {"cameras": cameras}
    }


def _changes(before: Any, after: Any, where: str) -> Iterator[str]:
    """Yield the differences, key by key."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in dict.fromkeys((*before, *after)):
            yield from _changes(before.get(key), after.get(key), f"{where}.{key}" if where else str(key))
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for number, pair in enumerate(zip(before, after, strict=True)):
            yield from _changes(*pair, f"{where}[{number}]")
    elif before != after:
        yield f"{where} is {_shown(after)}, not {_shown(before)}"


def _shown(value: Any) -> str:
    return (
        f"a list of {len(value)}" if isinstance(value, list) else "left out" if value is None else repr(value)
    )


@dataclass(frozen=True, slots=True, eq=False)
class ScoredRun:
    """The scores of a run.

    Attributes:
        name: name of its folder, or of the file with its tracks.
        tracker: name of the tracker.
        scene: the scene; None if unknown.
        scores: scores of the tracks.
        by: ground truth boxes of the scores; None for squares on the floor, footage and files.
        notes: caveats of the scores, one line each.
    """

    name: str
    tracker: str
    scene: Scene | None
    scores: Scores
    by: BoxReference | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Difference:
    """Difference between two trackers over the scenes that both have runs of.

    Attributes:
        tracker: the tracker with the higher metric if a difference is positive.
        other: the tracker it is compared with.
        pairs: number of scenes.
        figures: mean difference with its interval and test, by name of the metric.
    """

    tracker: str
    other: str
    pairs: int
    figures: Mapping[str, PairedDifference]


Groups = Mapping[str, Sequence[ScoredRun]]


def score_by_tracker(folders: Sequence[Path], options: ScoreOptions | None = None) -> Groups:
    """Score the runs in these folders, and group them by tracker, in the order of first appearance.

    Raises:
        BadInput: as for `evaluate_runs`, or a run does not name its tracker, or scenes with the same name
            differ between trackers.
    """
    groups: dict[str, list[ScoredRun]] = {}
    for folder, people in zip(folders, evaluate_runs(folders, options), strict=True):
        about = read_run(folder)
        tracker, seed = about.get("tracker"), about.get("seed")
        if not isinstance(tracker, str):
            raise BadInput(f"{folder / 'run.json'}: tracker: must be a name, got {tracker!r}; run it again")
        name = about.get("scenario", about.get("footage"))
        scene = (name, seed) if isinstance(name, str) and isinstance(seed, int) else None
        run = ScoredRun(str(folder), tracker, scene, people.scores, people.by, people.notes)
        groups.setdefault(tracker, []).append(run)
    check_same_scenes([{Path(run.name): run.scene for run in runs} for runs in groups.values()])
    return groups


def differences(groups: Groups, figures: Sequence[Figure] = FIGURES) -> list[Difference]:
    """Compare every other tracker with the first, over the scenes of which each of the two has one run."""
    (first, of_first), *others = groups.items()
    return [_difference(tracker, runs, first, of_first, figures) for tracker, runs in others]


def figures_of_all(groups: Groups, figures: Sequence[Figure] = FIGURES) -> dict[str, Any]:
    """Return metrics for JSON: of each run, of each tracker, and differences between trackers."""
    keys = {figure.name: figure.key for figure in figures}
    return {
        "trackers": {tracker: _together(runs, figures) for tracker, runs in groups.items()},
        "differences": [
            {
                "tracker": one.tracker,
                "from": one.other,
                "pairs": one.pairs,
                "metrics": {
                    keys[name]: None if math.isnan(apart.interval.mean) else apart.interval.to_json()
                    for name, apart in one.figures.items()
                },
                "p": {keys[name]: none_for_nan(apart.p) for name, apart in one.figures.items()},
            }
            for one in differences(groups, figures)
        ],
    }


def _together(runs: Sequence[ScoredRun], figures: Sequence[Figure]) -> dict[str, Any]:
    scores = [run.scores for run in runs]
    over = {one.figure.key: one for one in summarise(scores, figures)}
    return {
        "all_frames": to_json(combine(scores), figures),
        "mean_of_runs": {name: none_for_nan(one.mean) for name, one in over.items()},
        "deviation": {name: none_for_nan(one.sd) for name, one in over.items()},
        "interval": {name: one.interval.to_json()[1:] for name, one in over.items()},
        "runs": [_alone(run, figures) for run in runs],
    }


def _alone(run: ScoredRun, figures: Sequence[Figure]) -> dict[str, Any]:
    scene, seed = (None, None) if run.scene is None else run.scene
    by = {} if run.by is None else {"scored_by": run.by.to_json()}
    about = {"run": run.name, "scene": scene, "seed": seed, "notes": list(run.notes)}
    return about | {"metrics": by | to_json(run.scores, figures)}


def _difference(
    tracker: str,
    runs: Sequence[ScoredRun],
    other: str,
    of_other: Sequence[ScoredRun],
    figures: Sequence[Figure],
) -> Difference:
    ours, theirs = _once(runs), _once(of_other)
    scenes = [scene for scene in theirs if scene in ours]
    return Difference(
        tracker,
        other,
        len(scenes),
        {
            figure.name: compare_pairs([figure.of(ours[s]) - figure.of(theirs[s]) for s in scenes])
            for figure in figures
        },
    )


def _once(runs: Sequence[ScoredRun]) -> Mapping[Scene, Scores]:
    """Return the scores by scene, for scenes with exactly one run."""
    found: dict[Scene, list[Scores]] = {}
    for run in runs:
        if run.scene is not None:
            found.setdefault(run.scene, []).append(run.scores)
    return {scene: scores[0] for scene, scores in found.items() if len(scores) == 1}


_NAMES = tuple(ComfortScore.metrics())


def comfort_by_tracker(groups: Groups) -> Mapping[str, ComfortScore]:
    """Return the mean comfort metrics of each tracker; trackers without any are omitted.

    Undefined values of a run are omitted from the mean.

    Raises:
        BadInput: a run has other metrics than this version.
    """
    found = {tracker: [_figures(Path(run.name)) for run in runs] for tracker, runs in groups.items()}
    known = {tracker: [figures for figures in runs if figures is not None] for tracker, runs in found.items()}
    return {tracker: _mean(runs) for tracker, runs in known.items() if runs}


def _figures(folder: Path) -> list[float] | None:
    """Return the comfort metrics of a run in the order of `ComfortScore`; None if it has none."""
    path = folder / "metrics.json"
    if not path.is_file():
        return None
    try:
        group = read_json(path).get("comfort")
    except (OSError, ValueError, AttributeError) as error:
        raise BadInput(f"{path}: cannot be read as metrics; run the scenario again") from error
    if group is None:
        return None
    if not isinstance(group, dict) or set(group) != set(_NAMES):
        raise BadInput(f"{path}: comfort: not the metrics of this version; run the scenario again")
    try:
        return [math.nan if group[name] is None else float(group[name]) for name in _NAMES]
    except (TypeError, ValueError, OverflowError) as error:
        raise BadInput(f"{path}: comfort: must be numbers; run the scenario again") from error


def _mean(runs: list[list[float]]) -> ComfortScore:
    table = np.array(runs)
    means = [float(np.nanmean(c)) if np.isfinite(c).any() else math.nan for c in table.T]
    return ComfortScore(**dict(zip(_NAMES, means, strict=True)))
