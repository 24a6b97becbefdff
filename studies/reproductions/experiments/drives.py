"""Experiments with a depth camera, of the thesis on situation awareness: chapter 4 and appendix B."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.evaluations.drive_scores import RADIUS_M, DriveRecord
from peopleboy.studies.reproductions.evaluations.drive_tracking import (
    CHOICES,
    DEFAULT,
    LITERAL,
    NO_CONNECTOR,
    NO_DEPTH,
    NO_ODOMETRY,
    SETS,
    TURNS,
    set_name,
    watch_drive,
    watch_legs,
)
from peopleboy.studies.reproductions.experiment import Floats, Line, Row, Samples, as_columns
from peopleboy.studies.reproductions.pictures import situation_figures as figures
from peopleboy.studies.reproductions.plan import WHOLE_S, Plan, shortened
from peopleboy.studies.reproductions.statistics import bootstrap_interval
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.tracker.frame import DEPTH

ALL, MEASURED = "all", "measured"
MAIN: Final = (DEFAULT, LITERAL)
ABLATED: Final = (4, 6, 7, 10, 11, 12)
"""Numbers of the sets on which trackers are compared that differ in one thing."""
NOISIEST: Final = 3.0
_FOLLOWED: Final = 2  # number of the set in which the robot follows a person
_RANGES_M: Final = {"up to 3 m": (0.0, 3.0), "3 to 5 m": (3.0, 5.0), "5 to 10 m": (5.0, 10.0)}

Value = Callable[[DriveRecord], float]


def tracked(record: DriveRecord) -> Row:
    """Return table 4.1's values."""
    return {
        "images": record.frames,
        "FP per image": record.false_per_frame(),
        "TP": record.found(),
        "FN": record.missed,
        "rate": record.rate(),
        "switches": record.switches,
    }


def compared(record: DriveRecord) -> Row:
    """Return the values by which trackers are compared."""
    return {
        "rate": record.rate(),
        "FP per image": record.false_per_frame(),
        "switches": record.switches,
        "mean [m]": _mean(record.error_m),
        "median [m]": _median(record.error_m),
        "ms": record.ms,
    }


def errors_along(record: DriveRecord) -> Row:
    """Return table B.1's errors, sideways (x) and along the robot's axis (z), against the surface."""
    off = np.abs(record.hits[:, 5:7])
    z, x = off[np.isfinite(off).all(axis=1)].T
    return {"x [m]": _mean(x), "z [m]": _mean(z), "sd x [m]": float(x.std()), "sd z [m]": float(z.std())}


def position(record: DriveRecord, *, place: str, radius_m: float) -> Row:
    """Return how well positions are found within a radius of the body's middle, or of the surface seen."""
    off = record.error_m if place == "body" else record.surface_error_m
    off = off[off <= radius_m]
    return {
        "rate": record.rate(radius_m),
        "FP per image": record.false_per_frame(radius_m),
        "mean [m]": _mean(off),
        "median [m]": _median(off),
    }


def recall(record: DriveRecord, *, band: int) -> Row:
    """Return the pre-detection's recall of people by how much of them is hidden."""
    return {"recall": float(record.size_recall[band])}


def false_sizes(record: DriveRecord) -> Row:
    """Return the pre-detection's false alarms."""
    return {"false sizes per image": record.false_sizes / record.frames}


COLUMNS: Final[Mapping[str, Callable[..., Row]]] = {
    one.__name__: one for one in (tracked, compared, errors_along, position, recall, false_sizes)
}


def drives(
    using: Measurement,
    *,
    groups: Mapping[str, Mapping[str, Any]] | None = None,
    columns: str = "",
    drives: str = "sets",
    by_set: bool = False,
) -> Samples:
    """Score trackers on drives, one value a seed.

    Args:
        using: how much is measured, and what is there.
        groups: `tracker`, if it is not the default and the literal one, `scale` of the depth's noise, and
            `columns` with what these take.
        columns: one of `COLUMNS`.
        drives: "sets", or those that are "ablated", or those with many "turns".
        by_set: whether there is a group for each set, and one for all of them.
    """
    plan = using.plan
    declared = {name: {"columns": columns, **own} for name, own in (groups or {}).items()}
    if by_set:
        sets = {set_name(number): (number,) for number in plan.sets} | {ALL: plan.sets}
        declared = {name: {"columns": columns, "numbers": numbers} for name, numbers in sets.items()}
    units = {name: drive_units(plan, drives, own.get("scale", 1.0)) for name, own in declared.items()}
    using.results(unit for several in units.values() for unit in several)
    found = {}
    for name, own in declared.items():
        rest = {key: one for key, one in own.items() if key not in ("columns", "tracker", "scale", "numbers")}
        measure = partial(COLUMNS[own["columns"]], **rest)
        scenarios = [SETS[number - 1] for number in own.get("numbers", ())] or None
        for tracker in (own["tracker"],) if "tracker" in own else MAIN:
            records = by_seed(using, units[name], tracker, scenarios)
            found[Line(name, MEASURED if "tracker" in own else tracker)] = as_columns(map(measure, records))
    return found


_WANTED: Final[Mapping[str, Value]] = {
    "rate": DriveRecord.rate,
    "FP per image": DriveRecord.false_per_frame,
    "error, mean [m]": lambda record: _mean(record.error_m),
    "error, median [m]": lambda record: _median(record.error_m),
    "recall of the pre-detection, hidden < .1": lambda record: float(record.size_recall[0]),
    "false sizes per image": lambda record: record.false_sizes / record.frames,
}


def goals(using: Measurement) -> Samples:
    """Estimate what this project wants of its tracker: values with 95 % intervals over seeds."""
    plan = using.plan
    sets, noisy, turns = (
        drive_units(plan, kind, scale)
        for kind, scale in (("sets", 1.0), ("ablated", NOISIEST), ("turns", 1.0))
    )
    using.results([*sets, *noisy, *turns])
    everything = by_seed(using, sets, DEFAULT)
    rows = {name: _with_interval(everything, _joined(value)) for name, value in _WANTED.items()}
    by_set = [by_seed(using, sets, DEFAULT, [SETS[number - 1]]) for number in plan.sets]
    rows["rate of the worst set"] = _with_interval(list(zip(*by_set, strict=True)), _worst_rate)
    rows["rate, noise x 3"] = _with_interval(by_seed(using, noisy, DEFAULT), _joined(DriveRecord.rate))
    pairs = zip(*(by_seed(using, turns, name) for name in (NO_ODOMETRY, DEFAULT)), strict=True)
    rows["switches a run in turns, saved by odometry"] = _with_interval(list(pairs), _saved_switches)
    return {Line(name, DEFAULT): row for name, row in rows.items()}


def _joined(value: Value) -> Callable[[Sequence[DriveRecord]], float]:
    return lambda records: value(DriveRecord.joined(records))


def _worst_rate(seeds: Sequence[Sequence[DriveRecord]]) -> float:
    return float(np.nanmin([DriveRecord.joined(records).rate() for records in zip(*seeds, strict=True)]))


def _saved_switches(pairs: Sequence[Sequence[DriveRecord]]) -> float:
    return sum(without.switches - with_it.switches for without, with_it in pairs) / len(pairs)


def _with_interval(parts: Sequence[Any], value: Callable[[Sequence[Any]], float]) -> dict[str, Floats]:
    numbers = (value(parts), *bootstrap_interval(parts, value))
    return {name: np.array([number]) for name, number in zip(("figure", "from", "to"), numbers, strict=True)}


def draw_drives(using: Measurement, *, figure: str, sets: Sequence[int]) -> Figure | None:
    """Draw some sets, each played with seed 0; None where a plan leaves out all of them."""
    names = tuple(CHOICES) if figure == "crossing" else MAIN
    units = {set_name(n): drive_unit(using.plan, SETS[n - 1], 0, names) for n in sets if n in using.plan.sets}
    runs = dict(zip(units, using.results(units.values()), strict=True))
    return _FIGURES[figure](runs) if runs else None


def _only(runs: Mapping[str, Result]) -> Result:
    (run,) = runs.values()
    return run


_FIGURES: Final[Mapping[str, Callable[[Mapping[str, Result]], Figure]]] = {
    "paths": lambda runs: figures.draw_ways(runs, DEFAULT),
    "world": lambda runs: figures.draw_world(_only(runs), DEFAULT),
    "people": lambda runs: figures.draw_people(runs, DEFAULT),
    "errors": lambda runs: figures.draw_errors(_only(runs), DEFAULT),
    "crossing": lambda runs: figures.draw_crossing(
        _only(runs), {NO_DEPTH: "filters without depth", DEFAULT: "filters with depth"}
    ),
}


def legs(using: Measurement) -> Samples:
    """Find by range in which share of the images the person is found, by depth and by legs."""
    (run,) = using.results([_legs_unit(using.plan)])
    return {
        Line(group, name): as_columns([{"rate": _found(run["truth"], run[key], *limits)}])
        for group, limits in _RANGES_M.items()
        for name, key in ((DEFAULT, "depth"), ("legs", "legs"))
    }


def draw_legs(using: Measurement) -> Figure:
    """Draw the true path, and those by depth and by legs."""
    return figures.draw_legs(*using.results([_legs_unit(using.plan)]))


def _found(
    truth: Sequence[Sequence[float]], tracked: Sequence[Sequence[float]], nearest_m: float, farthest_m: float
) -> float:
    """Return in which share of the images a person in plain view and range is placed within 1 m."""
    places: dict[int, list[Sequence[float]]] = {}
    for frame, _, *place in tracked:
        places.setdefault(int(frame), []).append(place)
    wanted = [row for row in truth if row[6] and nearest_m <= row[4] < farthest_m]
    hits = [
        any(np.hypot(x - row[2], y - row[3]) <= RADIUS_M for x, y in places.get(int(row[0]), []))
        for row in wanted
    ]
    return float(np.mean(hits)) if hits else float("nan")


def drive_units(plan: Plan, drives: str, scale: float = 1.0) -> list[Unit]:
    """List drives of a kind, seed by seed; with the usual noise all trackers see those that are ablated."""
    if drives == "sets":
        return [drive_unit(plan, SETS[n - 1], seed, MAIN) for seed in range(plan.drives) for n in plan.sets]
    if drives == "turns":
        return [drive_unit(plan, TURNS, seed, (DEFAULT, NO_ODOMETRY)) for seed in range(2 * plan.drives)]
    names = tuple(CHOICES) if scale == 1.0 else (DEFAULT, NO_CONNECTOR)
    scenarios = [SETS[n - 1] for n in plan.sets if n in ABLATED]
    return [drive_unit(plan, one, seed, names, scale) for one in scenarios for seed in range(plan.ablated)]


def drive_unit(plan: Plan, scenario: str, seed: int, names: tuple[str, ...], scale: float = 1.0) -> Unit:
    """Play a drive once for some trackers, cut where time is short, with the depth's noise scaled."""
    cut = f" {plan.drive_s:g}s" if plan.drive_s < WHOLE_S else ""
    key = f"drive {scenario}-{seed}{cut} noise {scale:g} | {', '.join(names)}"
    return Unit(key, score_drive, (scenario, seed, names, scale, plan.drive_s))


def _legs_unit(plan: Plan) -> Unit:
    scenario = SETS[_FOLLOWED - 1]
    return Unit(f"legs {scenario} {plan.drive_s:g}s", score_legs, (scenario, plan.drive_s))


def score_drive(scenario: str, seed: int, names: tuple[str, ...], scale: float, most_s: float) -> Result:
    """Play and score a drive."""
    played = shortened(scenario, most_s)
    if scale != 1.0:
        played = played.with_cameras({DEPTH: {"kind": DEPTH, "scale": scale}})
    return watch_drive(played, seed, names)


def score_legs(scenario: str, most_s: float) -> Result:
    """Follow a person by legs and by depth and colour at the same time."""
    return watch_legs(shortened(scenario, most_s), 0)


def by_seed(
    using: Measurement, units: Sequence[Unit], tracker: str, scenarios: Sequence[str] | None = None
) -> list[DriveRecord]:
    """Return what a tracker did in some scenarios, or all, taken together by seed."""
    seeds: dict[int, list[DriveRecord]] = {}
    for unit, result in zip(units, using.results(units), strict=True):
        scenario, seed, *_ = unit.arguments
        if scenarios is None or scenario in scenarios:
            seeds.setdefault(seed, []).append(DriveRecord.of_plain(result[tracker]))
    return [DriveRecord.joined(records) for _, records in sorted(seeds.items())]


def _mean(errors: Floats) -> float:
    return float(errors.mean()) if errors.size else float("nan")


def _median(errors: Floats) -> float:
    return float(np.median(errors)) if errors.size else float("nan")
