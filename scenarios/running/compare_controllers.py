"""Compare controllers on the same scenarios and seeds, with confidence intervals."""

import json
import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.tracker_by_name import tracker_cameras
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.scenarios.running.many_runs import RunTask, play, unfinished
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.scores.bootstrap import (
    Interval,
    PairedDifference,
    bootstrap,
    compare_pairs,
    none_for_nan,
)
from peopleboy.scenarios.scores.comfort_metrics import ComfortScore
from peopleboy.scenarios.scores.episode_result import DRIVE_GROUPS
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.trackers import DEFAULT_TRACKER, is_own
from peopleboy.user_files import read_json


@dataclass(frozen=True, slots=True)
class Controller:
    """A behaviour by name or module:Class, and the tracker that it uses; written behaviour@tracker."""

    behaviour: str
    eyes: str

    def __str__(self) -> str:
        """Return the name, without the tracker if it is the default."""
        return self.behaviour if self.eyes == DEFAULT_TRACKER else f"{self.behaviour}@{self.eyes}"


Figures = Mapping[str, float]


def parse_controller(text: str) -> Controller:
    """Parse a controller from behaviour or behaviour@tracker.

    Raises:
        BadInput: the behaviour or the tracker is unknown.
    """
    behaviour, at, eyes = text.strip().partition("@")
    make_behaviour(behaviour)
    controller = Controller(behaviour, eyes if at else DEFAULT_TRACKER)
    tracker_cameras(controller.eyes)  # raises for an unknown name
    return controller


def compare(
    scenario: str | Path | Scenario,
    controllers: Sequence[Controller],
    seeds: Iterable[int],
    options: RunOptions,
    workers: Workers,
) -> dict[Controller, list[Figures]]:
    """Run a scenario with every controller and seed, and collect the metrics of how the robot drove.

    A killed comparison resumes when it is called again.

    Args:
        scenario: name, path, or a loaded scenario.
        controllers: the controllers to compare.
        seeds: seeds, the same for all controllers.
        options: options of a run; `out` is the folder of all runs, each in CONTROLLER-SEED, and `boxes` is
            for your own trackers, because the shipped ones give torso boxes.
        workers: workers that execute the runs.

    Returns:
        For each controller, the metrics of each seed; undefined ones are NaN.

    Raises:
        BadInput: a run is invalid, a controller is given twice, `boxes` asks for whole people but no tracker
            is your own, or the folder of a run holds another complete run.
        TasksFailed: some runs failed.
    """
    if len(set(controllers)) < len(controllers):
        raise BadInput(f"--controllers {','.join(map(str, controllers))}: give each only once")
    if options.boxes is not BoxKind.TORSO and not any(is_own(controller.eyes) for controller in controllers):
        raise BadInput(f"--boxes {options.boxes}: no controller uses your own tracker; leave it out")
    loaded = load_scenario(scenario)
    tasks = {
        (controller, seed): RunTask(loaded, _options(options, controller, seed))
        for seed in seeds
        for controller in controllers
    }
    play(unfinished(list(tasks.values())), workers, loaded.name)
    return {
        controller: [figures_of(task.options.out) for (who, _), task in tasks.items() if who == controller]
        for controller in controllers
    }


def _options(options: RunOptions, controller: Controller, seed: int) -> RunOptions:
    return replace(
        options,
        seed=seed,
        out=options.out / f"{controller}-{seed}".replace(":", "."),
        behaviour=controller.behaviour,
        tracker=controller.eyes,
        boxes=options.boxes if is_own(controller.eyes) else BoxKind.TORSO,
        record=False,
    )


def intervals(runs: Sequence[Figures], rng: np.random.Generator) -> dict[str, Interval]:
    """Return the mean of every metric over some runs, with its confidence interval."""
    names = list(dict.fromkeys(name for figures in runs for name in figures))
    return {name: bootstrap([figures.get(name, math.nan) for figures in runs], rng) for name in names}


def paired_differences(
    runs: Mapping[Controller, Sequence[Figures]],
) -> dict[Controller, dict[str, PairedDifference]]:
    """Compare the metrics of every other controller with those of the first, run by run."""
    (_, of_first), *others = runs.items()
    return {controller: _differences(of_first, of_other) for controller, of_other in others}


def _differences(of_first: Sequence[Figures], of_other: Sequence[Figures]) -> dict[str, PairedDifference]:
    names = list(dict.fromkeys(name for figures in (*of_first, *of_other) for name in figures))
    pairs = list(zip(of_first, of_other, strict=True))
    return {
        name: compare_pairs([two.get(name, math.nan) - one.get(name, math.nan) for one, two in pairs])
        for name in names
    }


def figures_of(folder: Path) -> dict[str, float]:
    """Read the metrics of how the robot drove from a run's folder; booleans become 1 and 0."""
    metrics = read_json(folder / "metrics.json")
    groups = [metrics[name] for name in DRIVE_GROUPS if name in metrics]
    return {
        name: math.nan if value is None else float(value) for group in groups for name, value in group.items()
    }


# Output of a comparison: a table, a plot and a JSON file.

_SHARES = {
    "found", "followed", "in_band", "facing", "in_band_and_facing", "followed_to_end", "path_efficiency"
}  # fmt: skip
_COLUMNS = 4
_DOTS = np.random.default_rng(0).uniform(-0.12, 0.12, 1000)


def show_comparison(scenario: str, runs: Mapping[Controller, Sequence[Figures]]) -> None:
    """Print the table."""
    means, apart = _means(runs), paired_differences(runs)
    count = len(next(iter(runs.values())))
    amount = f"{count} runs each: mean [95 % interval]" if count > 1 else "one run each, without an interval"
    first = next(iter(runs))
    table = Table(title=f"{scenario}, {amount}", title_justify="left", box=None)
    table.add_column("figure")
    for controller in means:
        table.add_column(str(controller), justify="right")
    for controller in apart:
        table.add_column(f"{controller} - {first}", justify="right")
    for name in _names(means):
        cells = [_cell(of_one.get(name), name) for of_one in means.values()]
        table.add_row(_label(name), *cells, *[_apart(of_one[name], name) for of_one in apart.values()])
    width = None if sys.stdout.isatty() else 44 + 30 * len(means) + 60 * len(apart)
    Console(width=width).print(table)
    if count > 1 and apart:
        print("Differences are of runs of the same scenario and seed; p is of the Wilcoxon signed-rank test.")


def keep_comparison(
    scenario: str, runs: Mapping[Controller, Sequence[Figures]], out: Path
) -> Mapping[str, Any]:
    """Write comparison.png and comparison.json, and return the contents of the latter."""
    means = _means(runs)
    content = _content(scenario, runs, means)
    (out / "comparison.json").write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    _draw(out / "comparison.png", scenario, _names(means), runs, means)
    return content


def _means(runs: Mapping[Controller, Sequence[Figures]]) -> Mapping[Controller, Mapping[str, Interval]]:
    rng = np.random.default_rng(0)
    return {controller: intervals(figures, rng) for controller, figures in runs.items()}


def _names(means: Mapping[Controller, Mapping[str, Interval]]) -> list[str]:
    return list(dict.fromkeys(name for of_one in means.values() for name in of_one))


def _label(name: str) -> str:
    """Return a label with a unit for a key of metrics.json; comfort metrics use their usual labels."""
    if name in ComfortScore.metrics():
        return ComfortScore.metrics()[name].label
    stem, unit = name, "%" if name in _SHARES else ""
    for ending, written in (("_m_s3", "m/s3"), ("_m_s", "m/s"), ("_rad", "deg"), ("_m", "m"), ("_s", "s")):
        if stem.endswith(ending):
            stem, unit = stem.removesuffix(ending), written
            break
    words = stem.replace("_", " ")
    return f"{words}, {unit}" if unit else words


def _scale(name: str) -> float:
    return 100.0 if name in _SHARES else math.degrees(1.0) if name.endswith("_rad") else 1.0


def _cell(interval: Interval | None, name: str) -> str:
    if interval is None or math.isnan(interval.mean):
        return "-"
    mean, low, high = (_scale(name) * value for value in (interval.mean, interval.low, interval.high))
    return f"{mean:.2f} [{low:.2f}, {high:.2f}]" if interval.is_known else f"{mean:.2f}"


def _apart(apart: PairedDifference, name: str) -> str:
    text = _cell(apart.interval, name)
    return text if math.isnan(apart.p) else f"{text}, p = {apart.p:.2g}"


def _content(
    scenario: str,
    runs: Mapping[Controller, Sequence[Figures]],
    means: Mapping[Controller, Mapping[str, Interval]],
) -> dict[str, Any]:
    return {
        "scenario": scenario,
        "controllers": {
            str(controller): {
                "runs": [{k: none_for_nan(v) for k, v in figures.items()} for figures in of_one],
                "mean": {name: interval.to_json() for name, interval in means[controller].items()},
            }
            for controller, of_one in runs.items()
        },
        "differences": [
            {
                "controller": str(controller),
                "from": str(next(iter(runs))),
                "mean": {name: one.interval.to_json() for name, one in of_one.items()},
                "p": {name: none_for_nan(one.p) for name, one in of_one.items()},
            }
            for controller, of_one in paired_differences(runs).items()
        ],
    }


def _draw(
    path: Path,
    scenario: str,
    names: Sequence[str],
    runs: Mapping[Controller, Sequence[Figures]],
    means: Mapping[Controller, Mapping[str, Interval]],
) -> None:
    """Draw a panel for each metric: a dot for every run, and the mean with its interval next to them."""
    rows = max(math.ceil(len(names) / _COLUMNS), 1)
    figure = Figure(figsize=(3.6 * _COLUMNS, 0.8 + rows * (1.1 + 0.32 * len(runs))), layout="constrained")
    FigureCanvasAgg(figure)
    is_many = len(next(iter(runs.values()))) > 1
    amount = "every run, and the mean with its 95 % interval" if is_many else "one run each"
    figure.suptitle(f"{scenario}: {amount}")
    grid = figure.subplots(rows, _COLUMNS, squeeze=False)
    for axes, name in zip(grid.flat, names, strict=False):
        for row, controller in enumerate(runs):
            values = np.array([_scale(name) * of_run.get(name, math.nan) for of_run in runs[controller]])
            axes.plot(values, row + _DOTS[: len(values)], ".", color=f"C{row}", alpha=0.35, markersize=5)
            interval = means[controller].get(name)
            if interval is not None and not math.isnan(interval.mean):
                low, mean, high = (_scale(name) * v for v in (interval.low, interval.mean, interval.high))
                axes.plot([low, high], [row, row], color=f"C{row}", linewidth=2.5)
                axes.plot([mean], [row], "D", color=f"C{row}", markersize=6)
        _limit(axes, [_scale(name) * of_run.get(name, math.nan) for of in runs.values() for of_run in of])
        axes.set_title(_label(name), fontsize=9)
        axes.set_yticks(range(len(runs)), [str(controller) for controller in runs], fontsize=7)
        axes.set_ylim(len(runs) - 0.5, -0.5)
        axes.tick_params(axis="x", labelsize=7)
    for axes in grid.flat[len(names) :]:
        axes.set_axis_off()
    figure.savefig(path, dpi=110)


def _limit(axes: Axes, values: Sequence[float]) -> None:
    """Mark a panel without defined values, and include 0 in the axis if a metric is the same in all runs."""
    known = [value for value in values if not math.isnan(value)]
    if not known:
        axes.text(0.5, 0.5, "not defined in any run", ha="center", va="center", transform=axes.transAxes)
        axes.set_xticks([])
    elif min(known) == max(known):
        far = known[0] or 1.0
        axes.set_xlim(min(-0.05 * far, 1.15 * far), max(-0.05 * far, 1.15 * far))
