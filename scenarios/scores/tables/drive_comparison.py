"""Comparison of how robots drove with several controllers: a table's cells, a plot and a JSON file."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from peopleboy.scenarios.scores.bootstrap import (
    Interval,
    PairedDifference,
    bootstrap,
    compare_pairs,
    none_for_nan,
)
from peopleboy.scenarios.scores.drive_record import Metric
from peopleboy.scenarios.scores.episode_result import DRIVE_GROUPS, DRIVE_METRICS
from peopleboy.user_files import read_json

DriveFigures = Mapping[str, float]
"""Metrics of how the robot drove in a run, by their key in metrics.json; NaN for undefined ones."""

_COLUMNS: Final = 4  # of panels
_DOTS: Final = np.random.default_rng(0).uniform(-0.12, 0.12, 1000)  # keep the dots of runs apart


def figures_of(folder: Path) -> dict[str, float]:
    """Read the metrics of how the robot drove from a run's folder; booleans become 1 and 0."""
    metrics = read_json(folder / "metrics.json")
    groups = [metrics[name] for name in DRIVE_GROUPS if name in metrics]
    return {
        name: math.nan if value is None else float(value) for group in groups for name, value in group.items()
    }


@dataclass(frozen=True, eq=False)
class DriveComparison:
    """Metrics of several controllers in the same scenes, and their differences from the first controller.

    Attributes:
        scenario: name of the scenario, or of several.
        runs: metrics of each run, by controller; the runs of all controllers are of the same scenes.
    """

    scenario: str
    runs: Mapping[str, Sequence[DriveFigures]]

    @property
    def count(self) -> int:
        """Number of runs of each controller."""
        return len(self.runs[self.first])

    @property
    def first(self) -> str:
        """Controller with which the others are compared."""
        return next(iter(self.runs))

    @cached_property
    def metrics(self) -> Mapping[str, Metric]:
        """Metrics that any run has, by their key."""
        return {key: DRIVE_METRICS[key] for key in _keys(run for runs in self.runs.values() for run in runs)}

    @cached_property
    def means(self) -> Mapping[str, Mapping[str, Interval]]:
        """Mean of every metric of each controller, with its confidence interval."""
        return {
            controller: {
                key: bootstrap([run.get(key, math.nan) for run in runs], np.random.default_rng(0))
                for key in _keys(runs)
            }
            for controller, runs in self.runs.items()
        }

    @cached_property
    def differences(self) -> Mapping[str, Mapping[str, PairedDifference]]:
        """Differences of every other controller from the first, run by run."""
        (_, of_first), *others = self.runs.items()
        return {controller: _differences(of_first, of_other) for controller, of_other in others}

    def to_json(self) -> dict[str, Any]:
        """Return runs, means and differences for JSON, in the units of metrics.json."""
        return {
            "scenario": self.scenario,
            "controllers": {
                controller: {
                    "runs": [{key: none_for_nan(value) for key, value in run.items()} for run in runs],
                    "mean": {key: interval.to_json() for key, interval in self.means[controller].items()},
                }
                for controller, runs in self.runs.items()
            },
            "differences": [
                {
                    "controller": controller,
                    "from": self.first,
                    "mean": {key: one.interval.to_json() for key, one in apart.items()},
                    "p": {key: none_for_nan(one.p) for key, one in apart.items()},
                }
                for controller, apart in self.differences.items()
            ],
        }

    def save(self, folder: Path) -> None:
        """Write comparison.png and comparison.json."""
        text = json.dumps(self.to_json(), indent=2) + "\n"
        (folder / "comparison.json").write_text(text, encoding="utf-8")
        _draw(folder / "comparison.png", self)


def _keys(runs: Iterable[DriveFigures]) -> list[str]:
    return list(dict.fromkeys(key for run in runs for key in run))


def _differences(
    of_first: Sequence[DriveFigures], of_other: Sequence[DriveFigures]
) -> dict[str, PairedDifference]:
    pairs = list(zip(of_first, of_other, strict=True))
    return {
        key: compare_pairs([two.get(key, math.nan) - one.get(key, math.nan) for one, two in pairs])
        for key in _keys((*of_first, *of_other))
    }


def _draw(path: Path, found: DriveComparison) -> None:
    """Draw a panel for each metric: a dot for every run, and the mean with its interval next to them."""
    rows = max(math.ceil(len(found.metrics) / _COLUMNS), 1)
    size = (3.6 * _COLUMNS, 0.8 + rows * (1.1 + 0.32 * len(found.runs)))
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    amount = "every run, and the mean with its 95 % interval" if found.count > 1 else "one run each"
    figure.suptitle(f"{found.scenario}: {amount}")
    grid = figure.subplots(rows, _COLUMNS, squeeze=False)
    for axes, key in zip(grid.flat, found.metrics, strict=False):
        _draw_metric(axes, found, key)
    for axes in grid.flat[len(found.metrics) :]:
        axes.set_axis_off()
    figure.savefig(path, dpi=110)


def _draw_metric(axes: Axes, found: DriveComparison, key: str) -> None:
    metric, everything = found.metrics[key], []
    for row, (controller, runs) in enumerate(found.runs.items()):
        values = [metric.factor * run.get(key, math.nan) for run in runs]
        everything += values
        axes.plot(values, row + _DOTS[: len(values)], ".", color=f"C{row}", alpha=0.35, markersize=5)
        interval = found.means[controller].get(key)
        if interval is not None and not math.isnan(interval.mean):
            low, mean, high = (metric.factor * v for v in (interval.low, interval.mean, interval.high))
            axes.plot([low, high], [row, row], color=f"C{row}", linewidth=2.5)
            axes.plot([mean], [row], "D", color=f"C{row}", markersize=6)
    _limit(axes, everything)
    axes.set_title(metric.label, fontsize=9)
    axes.set_yticks(range(len(found.runs)), list(found.runs), fontsize=7)
    axes.set_ylim(len(found.runs) - 0.5, -0.5)
    axes.tick_params(axis="x", labelsize=7)


def _limit(axes: Axes, values: Sequence[float]) -> None:
    """Mark a panel without defined values, and include 0 in the axis if a metric is the same in all runs."""
    known = [value for value in values if not math.isnan(value)]
    if not known:
        axes.text(0.5, 0.5, "not defined in any run", ha="center", va="center", transform=axes.transAxes)
        axes.set_xticks([])
    elif min(known) == max(known):
        far = known[0] or 1.0
        axes.set_xlim(min(-0.05 * far, 1.15 * far), max(-0.05 * far, 1.15 * far))
