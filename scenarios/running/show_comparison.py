"""A comparison of controllers as a table, a picture and a file of figures."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table

from peopleboy.scenarios.running.compare_controllers import Controller, Figures, intervals
from peopleboy.scenarios.scores.bootstrap import Interval
from peopleboy.scenarios.scores.comfort_metrics import COMFORT_WORDS

_SHARES = {
    "found", "followed", "in_band", "facing", "in_band_and_facing", "followed_to_end", "path_efficiency"
}  # fmt: skip
_COLUMNS = 4
_DOTS = np.random.default_rng(0).uniform(-0.12, 0.12, 1000)


def show_comparison(scenario: str, runs: Mapping[Controller, Sequence[Figures]]) -> None:
    """Print the table."""
    means = _means(runs)
    seeds = len(next(iter(runs.values())))
    told = f"{seeds} seeds: mean [95 % interval]" if seeds > 1 else "one seed, which has no interval"
    table = Table(title=f"{scenario}, {told}", title_justify="left", box=None)
    table.add_column("figure")
    for controller in means:
        table.add_column(str(controller), justify="right")
    for name in _names(means):
        table.add_row(_label(name), *[_cell(of_one.get(name), name) for of_one in means.values()])
    Console(width=None if sys.stdout.isatty() else 44 + 30 * len(means)).print(table)


def keep_comparison(
    scenario: str, runs: Mapping[Controller, Sequence[Figures]], out: Path
) -> Mapping[str, Any]:
    """Write comparison.png and comparison.json, and give what the latter says."""
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
    """Turn a key of metrics.json into words with a unit; those of comfort are called as everywhere else."""
    if name in COMFORT_WORDS:
        return COMFORT_WORDS[name]
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


def _content(
    scenario: str,
    runs: Mapping[Controller, Sequence[Figures]],
    means: Mapping[Controller, Mapping[str, Interval]],
) -> dict[str, Any]:
    return {
        "scenario": scenario,
        "controllers": {
            str(controller): {
                "runs": [{k: _or_none(v) for k, v in figures.items()} for figures in of_one],
                "mean": {name: interval.to_json() for name, interval in means[controller].items()},
            }
            for controller, of_one in runs.items()
        },
    }


def _or_none(value: float) -> float | None:
    return None if math.isnan(value) else value


def _draw(
    path: Path,
    scenario: str,
    names: Sequence[str],
    runs: Mapping[Controller, Sequence[Figures]],
    means: Mapping[Controller, Mapping[str, Interval]],
) -> None:
    """Draw a panel for each figure: every seed as a dot, the mean with its interval beside."""
    rows = max(math.ceil(len(names) / _COLUMNS), 1)
    figure = Figure(figsize=(3.6 * _COLUMNS, 0.8 + rows * (1.1 + 0.32 * len(runs))), layout="constrained")
    FigureCanvasAgg(figure)
    seeds = len(next(iter(runs.values())))
    told = "every seed, and the mean with its 95 % interval" if seeds > 1 else "one seed"
    figure.suptitle(f"{scenario}: {told}")
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
    """Say that nothing is defined, and show a figure that is the same in all runs beside 0."""
    known = [value for value in values if not math.isnan(value)]
    if not known:
        axes.text(0.5, 0.5, "not defined in any run", ha="center", va="center", transform=axes.transAxes)
        axes.set_xticks([])
    elif min(known) == max(known):
        far = known[0] or 1.0
        axes.set_xlim(min(-0.05 * far, 1.15 * far), max(-0.05 * far, 1.15 * far))
