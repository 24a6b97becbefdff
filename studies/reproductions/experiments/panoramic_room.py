"""Experiments of the 2003 paper: errors of distance, angle and position by panorama, and by webcams."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.experiment import Line, Samples
from peopleboy.studies.reproductions.experiments import distance_trials as trials
from peopleboy.studies.reproductions.experiments.webcam_positions import measure_webcams
from peopleboy.studies.reproductions.image_errors import ErrorSummary, ImageErrors
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.studies.training.distance import Backpropagation, DistanceSamples, collect_distances

M, R, CM, DEGREES = "m", "|r|", "cm", "deg"
ROOMS: Final = ("room_long", "room_short", "room_narrow")
SPLITS: Final = {"random": "random split", "blocks": "by blocks"}
CUES: Final = (
    "feature 1, width",
    "feature 2, distance to the bottom",
    "feature 3, pixels",
    "appearance model",
)
ANGLE: Final = "angle of the person"

_ANGLES: Final = {
    "against the truth": "panorama_truth",
    "against webcams, all at once": "panorama_at_once",
    "against webcams up to 0.2 s apart": "panorama_skewed",
    "against webcams all 0.2 s late": "panorama_late",
}
_WEBCAMS: Final = {
    "known places": ("in_sample_m", None),
    "other places": ("new_m", None),
    "walking": ("walking_m", "bearing_deg"),
    "walking, webcams up to 0.2 s apart": ("skewed_m", "skewed_bearing_deg"),
}


def distances(
    using: Measurement, *, groups: Mapping[str, Mapping[str, Any]], has_new_people: bool = False
) -> Samples:
    """Measure errors [m] in every room, by both kinds of splits, with its runs combined.

    Args:
        using: the plan and stored results.
        groups: the `errors`, such as "general", and the `split`: "best", "worst" or all.
        has_new_people: whether the first group includes tests on new people.
    """
    walks = walks_of(using)
    units = {
        (room, SPLITS[split]): _split_units(using, room, split, walks[room])
        for room in ROOMS
        for split in SPLITS
    }
    folds = {(room, "new people"): _new_people_units(room, walks[room]) for room in ROOMS if has_new_people}
    tested = using.grouped(units | folds)
    found = {
        Line(group, f"{room}, {split}"): {
            M: ImageErrors.joined(_errors(result["errors"], **declared) for result in tested[room, split])
        }
        for group, declared in groups.items()
        for room, split in units
    }
    for room, split in folds:
        runs = [ImageErrors.of_plain(run) for result in tested[room, split] for run in result["runs"]]
        found[Line(next(iter(groups)), f"{room}, {split}")] = {M: ImageErrors.joined(runs)}
    return found


def _errors(plain: Mapping[str, Any], errors: Sequence[str], split: str = "all") -> ImageErrors:
    parts = [ImageErrors.of_plain(plain[name]) for name in errors]
    found = parts[0] if len(parts) == 1 else ImageErrors.merged(parts)
    choose = {"best": min, "worst": max}
    return found.only(choose[split]) if split in choose else found


def correlations(using: Measurement) -> Samples:
    """Correlate features and the network's estimate with the distance, one value per run (figure 5)."""
    walks = walks_of(using)
    tested = using.grouped({room: _split_units(using, room, "random", walks[room]) for room in ROOMS})
    r = {room: np.abs([result["r"] for result in results]) for room, results in tested.items()}
    return {Line(cue, room): {R: r[room][:, column]} for column, cue in enumerate(CUES) for room in ROOMS}


def webcams(using: Measurement) -> Samples:
    """Measure position errors by webcams [cm] and bearing errors [deg], one value per seed."""
    found = _webcam_runs(using)
    return {
        Line(group, "default"): {
            CM: np.array([100.0 * one[place] for one in found]),
            **({DEGREES: np.array([one[angle] for one in found])} if angle else {}),
        }
        for group, (place, angle) in _WEBCAMS.items()
    }


def angles(using: Measurement) -> Samples:
    """Measure errors of the panorama's angle [deg], in the rooms and against webcams."""
    found = {
        f"{room}, against the truth": [ErrorSummary.of(np.degrees(run.angle_error_rad)) for run in runs]
        for room, runs in walks_of(using).items()
    }
    for name, key in _ANGLES.items():
        found[f"corner_webcams, {name}"] = [ErrorSummary(*one[key]) for one in _webcam_runs(using)]
    return {
        Line(ANGLE, name): {DEGREES: ImageErrors.joined(ImageErrors(splits=(run,)) for run in runs)}
        for name, runs in found.items()
    }


def _webcam_runs(using: Measurement) -> list[Result]:
    return using.results(Unit.of(measure_webcams, seed) for seed in range(using.plan.repeats))


def walks_of(using: Measurement) -> dict[str, list[DistanceSamples]]:
    """Return by room the panoramic camera's measurements of walking people, run by run."""
    found = using.played(measure_walk, ROOMS, using.plan.walks)
    return {room: list(map(DistanceSamples.from_plain, runs)) for room, runs in found.items()}


def measure_walk(room: str, seed: int) -> Result:
    """Return the unit that simulates walking people in a room, and measures them."""
    return collect_distances(room, seed).to_plain()


def _split_units(using: Measurement, room: str, split: str, walks: Sequence[DistanceSamples]) -> list[Unit]:
    """Train the paper's networks on each run, with all splits of one kind."""
    trial = trials.SplitTrial(split=split, repeats=using.plan.splits)
    more = f"{split}, {trial.repeats} splits, {trial.settings.epochs} epochs"
    return [
        Unit(f"distances {room}-{seed} | {more}", score_splits, (examples, trial))
        for seed, examples in enumerate(walks)
    ]


def _new_people_units(room: str, walks: Sequence[DistanceSamples]) -> list[Unit]:
    """Train on the even seeds and test on the odd ones, and the other way round."""
    settings = Backpropagation()
    folds = [tuple(range(first, len(walks), 2)) for first in range(2)]
    return [
        Unit(
            f"new people {room} {','.join(map(str, seeds))} of {len(walks)} | {settings.epochs} epochs",
            score_new_people,
            (seeds, settings, tuple(walks)),
        )
        for seeds in folds
    ]


def score_splits(run: DistanceSamples, trial: trials.SplitTrial) -> Result:
    """Train networks on splits of a run, and test them, and the filter on their positions."""
    trained = trials.general_networks(run, trial)
    found = {"general": trials.general_trials(run, trained)}
    for (tested, model), errors in trials.personal_trials(run, trial).items():
        found[f"person {tested}, model {model}"] = errors
    for kind, is_noisy in (("position", False), ("noisy", True)):
        for name, errors in trials.position_trials(run, trained, is_noisy=is_noisy).items():
            found[f"{kind}, {name}"] = errors
    plain = {name: errors.plain() for name, errors in found.items()}
    return {"errors": plain, "r": trials.correlations(run, trained).tolist()}


def score_new_people(
    seeds: Sequence[int], settings: Backpropagation, runs: Sequence[DistanceSamples]
) -> Result:
    """Train one network on the runs with some seeds, and test it on the others."""
    trained = [run for seed, run in enumerate(runs) if seed in seeds]
    others = [run for seed, run in enumerate(runs) if seed not in seeds]
    tested = trials.new_people_trials(trained, others, settings)
    return {"runs": [errors.plain() for errors in tested]}
