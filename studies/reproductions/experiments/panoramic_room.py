"""Experiments of the 2003 paper: errors of distances, angles and positions by panorama, and of webcams."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions import distance_trials as trials
from peopleboy.studies.reproductions.evaluations.webcam_positions import measure_webcams
from peopleboy.studies.reproductions.experiment import Line, Samples
from peopleboy.studies.reproductions.image_errors import ErrorSummary, ImageErrors
from peopleboy.studies.reproductions.pictures import panoramic_figures
from peopleboy.studies.reproductions.plan import Plan
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.studies.training.distance import DistanceSamples, collect_distances

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
    """Measure errors [m] in every room, by both kinds of splits, its runs taken together.

    Args:
        using: how much is measured, and what is there.
        groups: whose `errors` are meant, such as "general", and of which `split`: "best", "worst" or all.
        has_new_people: whether networks are tested on people who are new to them, in the first group.
    """
    walks = {room: examples_of(using, room) for room in ROOMS}
    units = {
        (room, split): _split_units(using.plan, room, split, walks[room])
        for room in ROOMS
        for split in SPLITS
    }
    folds = {
        (room, "new people"): _new_people_units(using.plan, room, walks[room])
        for room in ROOMS
        if has_new_people
    }
    tested = using.grouped({**units, **folds})
    found = {
        Line(group, f"{room}, {SPLITS[split]}"): {
            M: ImageErrors.joined(_errors(result["errors"], **declared) for result in tested[room, split])
        }
        for group, declared in groups.items()
        for room, split in units
    }
    for room, new_people in folds:
        runs = [run for result in tested[room, new_people] for run in result["runs"]]
        line = Line(next(iter(groups)), f"{room}, {new_people}")
        found[line] = {M: ImageErrors.joined(map(ImageErrors.of_plain, runs))}
    return found


def _errors(plain: Mapping[str, Any], errors: Sequence[str], split: str = "all") -> ImageErrors:
    parts = [ImageErrors.of_plain(plain[name]) for name in errors]
    found = parts[0] if len(parts) == 1 else ImageErrors.merged(parts)
    return found.best() if split == "best" else found.worst() if split == "worst" else found


def draw_ranges(using: Measurement) -> Figure:
    """Draw the error over the distance."""
    return panoramic_figures.draw_ranges({room: examples_of(using, room) for room in ROOMS})


def correlations(using: Measurement) -> Samples:
    """Correlate features and the network's answer with the distance, one value a run (figure 5)."""
    walks = {room: examples_of(using, room) for room in ROOMS}
    tested = using.grouped({room: _split_units(using.plan, room, "random", walks[room]) for room in ROOMS})
    r = {room: np.abs([result["r"] for result in results]) for room, results in tested.items()}
    return {Line(cue, room): {R: r[room][:, column]} for column, cue in enumerate(CUES) for room in ROOMS}


def draw_correlations(using: Measurement) -> Figure:
    """Draw the correlations of the first run, as the paper does."""
    return panoramic_figures.draw_correlations(examples_of(using, ROOMS[0])[0], CUES)


def draw_path(using: Measurement) -> Figure:
    """Draw a piece of a path on the floor, true and estimated (figure 6)."""
    (first,) = using.results(walk_units(using.plan, ROOMS[0])[:1])
    return panoramic_figures.draw_path(DistanceSamples.from_plain(first))


def webcams(using: Measurement) -> Samples:
    """Measure errors of places [cm] by webcams, and of the bearing from the robot [deg], one value a seed."""
    found = using.results(_webcam_units(using.plan))
    return {
        Line(group, "default"): {
            CM: np.array([100.0 * one[place] for one in found]),
            **({DEGREES: np.array([one[angle] for one in found])} if angle else {}),
        }
        for group, (place, angle) in _WEBCAMS.items()
    }


def angles(using: Measurement) -> Samples:
    """Measure errors of the panorama's angle [deg], in the rooms and against webcams."""
    plan = using.plan
    using.results([*(unit for room in ROOMS for unit in walk_units(plan, room)), *_webcam_units(plan)])
    found = {}
    for room in ROOMS:
        degrees = (np.degrees(run.angle_error_rad) for run in examples_of(using, room))
        found[f"{room}, against the truth"] = _runs(map(ErrorSummary.of, degrees))
    for name, key in _ANGLES.items():
        kept = (ErrorSummary(**one[key]) for one in using.results(_webcam_units(plan)))
        found[f"corner_webcams, {name}"] = _runs(kept)
    return {Line(ANGLE, name): {DEGREES: errors} for name, errors in found.items()}


def _runs(runs: Iterable[ErrorSummary]) -> ImageErrors:
    return ImageErrors.joined(ImageErrors(splits=(run,)) for run in runs)


def walk_units(plan: Plan, room: str) -> list[Unit]:
    """List the runs in which people walk in a room before the panoramic camera."""
    return [Unit(f"walk {room}-{seed}", measure_walk, (room, seed)) for seed in range(plan.walks)]


def measure_walk(room: str, seed: int) -> Result:
    """Run people through a room, and keep what is measured of them."""
    return collect_distances(room, seed).to_plain()


def examples_of(using: Measurement, room: str) -> list[DistanceSamples]:
    """Return what was measured in each run; all rooms' runs are asked for at once."""
    using.results(unit for one in ROOMS for unit in walk_units(using.plan, one))
    return [DistanceSamples.from_plain(result) for result in using.results(walk_units(using.plan, room))]


def _split_units(plan: Plan, room: str, split: str, walks: Sequence[DistanceSamples]) -> list[Unit]:
    """Train the paper's networks on each run, with all splits of one kind."""
    trial = trials.SplitTrial(split=split, repeats=plan.splits)
    more = f"{split}, {trial.repeats} splits, {trial.settings.epochs} epochs"
    return [
        Unit(f"distances {walk.key} | {more}", score_splits, (examples, trial))
        for walk, examples in zip(walk_units(plan, room), walks, strict=True)
    ]


def _new_people_units(plan: Plan, room: str, walks: Sequence[DistanceSamples]) -> list[Unit]:
    """Train on the even seeds and test on the odd ones, and the other way round."""
    trial = trials.SplitTrial(split="random", repeats=1)
    folds = [tuple(range(first, plan.walks, 2)) for first in range(2)]
    return [
        Unit(
            f"new people {room} {','.join(map(str, seeds))} of {len(walks)} | {trial.settings.epochs} epochs",
            score_new_people,
            (seeds, trial, tuple(walks)),
        )
        for seeds in folds
    ]


def _webcam_units(plan: Plan) -> list[Unit]:
    return [Unit(f"webcams | {seed}", score_webcams, (seed,)) for seed in range(plan.repeats)]


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
    seeds: Sequence[int], trial: trials.SplitTrial, runs: Sequence[DistanceSamples]
) -> Result:
    """Train one network on the runs with some seeds, and test it on the others."""
    trained = [run for seed, run in enumerate(runs) if seed in seeds]
    others = [run for seed, run in enumerate(runs) if seed not in seeds]
    tested = trials.new_people_trials(trained, others, trial.settings)
    return {"runs": [errors.plain() for errors in tested]}


def score_webcams(seed: int) -> Result:
    """Play the scene with webcams, and measure their errors."""
    return measure_webcams(seed)
