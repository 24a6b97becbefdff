"""Tables of the thesis on situation awareness that come of drives with a depth camera."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.reproductions.evaluations.drive_scores import CLOSE_M, RADIUS_M, DriveRecord, interval
from peopleboy.studies.reproductions.evaluations.drive_tracking import (
    CHOICES,
    DEFAULT,
    LITERAL,
    NO_CONNECTOR,
    NO_ODOMETRY,
    SETS,
    TURNS,
    set_name,
)
from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.drive_units import DriveUnit
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan

ALL, MEASURED = "all", "measured"
MAIN: Final = (DEFAULT, LITERAL)
ABLATED: Final = (4, 6, 7, 10, 11, 12)
"""Numbers of the sets on which trackers are compared that differ in one thing."""
SCALES: Final = (0.0, 1.0, 3.0)

Floats = NDArray[np.float64]
Row = dict[str, float]
Measure = Callable[[DriveRecord], Row]


def tracked(record: DriveRecord) -> Row:
    """Give table 4.1's figures."""
    return {
        "images": record.frames,
        "FP per image": record.false_per_frame(),
        "TP": record.found(),
        "FN": record.missed,
        "rate": record.rate(),
        "switches": record.switches,
    }


def compared(record: DriveRecord) -> Row:
    """Give the figures by which trackers are compared."""
    return {
        "rate": record.rate(),
        "FP per image": record.false_per_frame(),
        "switches": record.switches,
        "mean [m]": _mean(record.error_m),
        "median [m]": _median(record.error_m),
        "ms": record.ms,
    }


@dataclass(frozen=True, slots=True)
class SetTable:
    """Figures of each set, and of all together, one for each seed."""

    id: str
    measure: Measure
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Every drive."""
        return missing(all_drives(plan), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the figures of the default tracker and of the literal one."""
        groups = {set_name(number): (number,) for number in plan.sets} | {ALL: plan.sets}
        return {
            Line(group, who): columns(self.measure(one) for one in by_seed(plan, done, who, numbers))
            for group, numbers in groups.items()
            for who in MAIN
        }


@dataclass(frozen=True, slots=True)
class AllSets:
    """Figures of all sets together, one for each seed, by what is measured."""

    id: str
    measures: Mapping[str, Measure]
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Every drive."""
        return missing(all_drives(plan), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the figures of all sets together, by seed."""
        return {
            Line(group, who): columns(measure(one) for one in by_seed(plan, done, who, plan.sets))
            for group, measure in self.measures.items()
            for who in MAIN
        }


@dataclass(frozen=True, slots=True)
class Ablations:
    """Trackers that differ in one thing, on the same films."""

    id: str = "situation-ablations"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Some of the sets, seen by all trackers."""
        return missing(noisy_drives(plan, 1.0), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the figures by seed."""
        units = noisy_drives(plan, 1.0)
        return {
            Line(name, MEASURED): columns(compared(one) for one in _seeds(units, done, name))
            for name in CHOICES
        }


@dataclass(frozen=True, slots=True)
class Noise:
    """The default tracker, and without its connector, with less and more noise of the sensor."""

    id: str = "situation-noise"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Some of the sets at every scale."""
        return missing([unit for scale in SCALES for unit in noisy_drives(plan, scale)], done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the figures by seed."""
        return {
            Line(f"noise x {scale:g}{name}", MEASURED): columns(
                compared(one) for one in _seeds(noisy_drives(plan, scale), done, who)
            )
            for scale in SCALES
            for name, who in (("", DEFAULT), (f", {NO_CONNECTOR}", NO_CONNECTOR))
        }


@dataclass(frozen=True, slots=True)
class Turning:
    """What odometry is worth where the robot turns: pairs of the same films."""

    id: str = "situation-odometry"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Drives with many turns."""
        return missing(turning_drives(plan), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the figures by seed."""
        names = {"with odometry": DEFAULT, "without odometry": NO_ODOMETRY}
        return {
            Line(group, MEASURED): columns(compared(one) for one in _seeds(turning_drives(plan), done, who))
            for group, who in names.items()
        }


@dataclass(frozen=True, slots=True)
class Goals:
    """What this project wants of its tracker, and what it has: 95 % intervals over seeds."""

    id: str = "situation-goals"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """All that the goals are about."""
        units: list[Unit] = [*all_drives(plan), *noisy_drives(plan, SCALES[-1]), *turning_drives(plan)]
        return missing(units, done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give one figure and its interval for each goal."""
        return {Line(name, DEFAULT): row for name, row in self._rows(plan, done)}

    def _rows(self, plan: Plan, done: Done) -> Iterator[tuple[str, dict[str, Floats]]]:
        everything = by_seed(plan, done, DEFAULT, plan.sets)
        for name, measure in _WANTED.items():
            yield name, _with_interval(everything, measure)
        sets = {number: by_seed(plan, done, DEFAULT, (number,)) for number in plan.sets}
        seeds = [{number: of_set[k] for number, of_set in sets.items()} for k in range(plan.drives)]
        yield "rate of the worst set", _figures(_worst_set(seeds), *interval(seeds, _worst_set))
        noisy = _seeds(noisy_drives(plan, SCALES[-1]), done, DEFAULT)
        yield "rate, noise x 3", _with_interval(noisy, DriveRecord.rate)
        pairs = list(
            zip(*(_seeds(turning_drives(plan), done, who) for who in (NO_ODOMETRY, DEFAULT)), strict=True)
        )
        yield "switches a run in turns, saved by odometry", _figures(_saved(pairs), *interval(pairs, _saved))


def drive(plan: Plan, scenario: str, seed: int, names: Sequence[str], scale: float = 1.0) -> DriveUnit:
    """Name a film, and who sees it."""
    return DriveUnit(scenario=scenario, seed=seed, names=tuple(names), scale=scale, most_s=plan.drive_s)


def all_drives(plan: Plan) -> list[DriveUnit]:
    """List every set's drives, seed by seed."""
    return [drive(plan, SETS[number - 1], seed, MAIN) for seed in range(plan.drives) for number in plan.sets]


def noisy_drives(plan: Plan, scale: float) -> list[DriveUnit]:
    """List the drives on which the sensor's noise is varied; all trackers see them with the usual one."""
    names = tuple(CHOICES) if scale == 1.0 else (DEFAULT, NO_CONNECTOR)
    sets = [number for number in plan.sets if number in ABLATED]
    return [drive(plan, SETS[n - 1], seed, names, scale) for n in sets for seed in range(plan.ablated)]


def turning_drives(plan: Plan) -> list[DriveUnit]:
    """List the drives with many turns."""
    return [drive(plan, TURNS, seed, (DEFAULT, NO_ODOMETRY)) for seed in range(2 * plan.drives)]


def by_seed(plan: Plan, done: Done, who: str, numbers: Sequence[int]) -> list[DriveRecord]:
    """Give what a tracker did on some sets together, by seed."""
    units = [drive(plan, SETS[n - 1], seed, MAIN) for n in numbers for seed in range(plan.drives)]
    return _seeds(units, done, who)


def columns(rows: Iterable[Row]) -> dict[str, Floats]:
    """Turn rows of figures into columns (R,)."""
    listed = list(rows)
    return {name: np.array([row[name] for row in listed], dtype=np.float64) for name in listed[0]}


def _seeds(units: Sequence[DriveUnit], done: Done, who: str) -> list[DriveRecord]:
    seeds: dict[int, list[DriveRecord]] = {}
    for unit in units:
        seeds.setdefault(unit.seed, []).append(DriveRecord.of_plain(done[unit.key][who]))
    return [DriveRecord.joined(records) for _, records in sorted(seeds.items())]


def _mean(errors: Floats) -> float:
    return float(errors.mean()) if errors.size else float("nan")


def _median(errors: Floats) -> float:
    return float(np.median(errors)) if errors.size else float("nan")


def errors_along(record: DriveRecord) -> Row:
    """Give table B.1's errors, sideways (x) and along the robot's axis (z), against the surface."""
    off = np.abs(record.hits[:, 5:7])
    z, x = off[np.isfinite(off).all(axis=1)].T
    return {"x [m]": _mean(x), "z [m]": _mean(z), "sd x [m]": float(x.std()), "sd z [m]": float(z.std())}


def _truth(radius_m: float, errors: Callable[[DriveRecord], Floats]) -> Measure:
    def measure(record: DriveRecord) -> Row:
        off = errors(record)
        off = off[off <= radius_m]
        return {
            "rate": record.rate(radius_m),
            "FP per image": record.false_per_frame(radius_m),
            "mean [m]": _mean(off),
            "median [m]": _median(off),
        }

    return measure


_TRUTHS: Final = {
    f"{place}, within {radius_m:g} m": _truth(radius_m, errors)
    for radius_m in (RADIUS_M, CLOSE_M)
    for place, errors in (
        ("middle of the body", lambda record: record.error_m),
        ("surface that is seen", lambda record: record.surface_error_m),
    )
}

_BANDS: Final = ("hidden < .1", "hidden < .4", "hidden < .7", "hidden more")


def _recall(band: int) -> Measure:
    return lambda record: {"recall": float(record.size_recall[band])}


_BY_SIZE: Final[Mapping[str, Measure]] = {
    **{name: _recall(band) for band, name in enumerate(_BANDS)},
    "nobody": lambda record: {"false sizes per image": record.false_sizes / record.frames},
}

_WANTED: Final[Mapping[str, Callable[[DriveRecord], float]]] = {
    "rate": DriveRecord.rate,
    "FP per image": DriveRecord.false_per_frame,
    "error, mean [m]": lambda record: _mean(record.error_m),
    "error, median [m]": lambda record: _median(record.error_m),
    "recall of the pre-detection, hidden < .1": lambda record: float(record.size_recall[0]),
    "false sizes per image": lambda record: record.false_sizes / record.frames,
}


def _with_interval(
    records: Sequence[DriveRecord], measure: Callable[[DriveRecord], float]
) -> dict[str, Floats]:
    def together(parts: Sequence[DriveRecord]) -> float:
        return measure(DriveRecord.joined(parts))

    return _figures(together(records), *interval(records, together))


def _figures(figure: float, low: float, high: float) -> dict[str, Floats]:
    return {"figure": np.array([figure]), "from": np.array([low]), "to": np.array([high])}


def _worst_set(seeds: Sequence[Mapping[int, DriveRecord]]) -> float:
    rates = [DriveRecord.joined(seed[number] for seed in seeds).rate() for number in seeds[0]]
    return float(np.nanmin(rates))


def _saved(pairs: Sequence[tuple[DriveRecord, DriveRecord]]) -> float:
    return sum(without.switches - with_it.switches for without, with_it in pairs) / len(pairs)


DRIVES = (
    SetTable("situation-table-4.1", tracked),
    SetTable("situation-table-B.1", errors_along),
    AllSets("situation-positions", _TRUTHS),
    Ablations(),
    Noise(),
    Turning(),
    AllSets("situation-pre-detection", _BY_SIZE),
    Goals(),
)
"""Experiments of chapter 4 and appendix B of that thesis."""
