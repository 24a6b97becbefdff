"""Plot the values of experiments as SVG pictures that are embedded in the page."""

import base64
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from peopleboy.studies.reproductions.canvas import finish, svg, svg_axes
from peopleboy.studies.reproductions.experiment import SOURCE, Experiment, Samples
from peopleboy.studies.reproductions.statistics import mean_and_spread

COLOURS = {
    SOURCE: "#1a1a1a",
    "literal": "#d95f02",
    "literal, strict": "#f4a76a",
    "literal, strict, own range": "#fad3bc",
    "literal, half in view": "#8c3d00",
    "default": "#1f78b4",
    "default, strict, own range": "#c7dded",
    "default, half in view": "#0d3c5a",
    "default, strict": "#8fbbd9",
    "literal, held out": "#d95f02",
    "literal, unseen scenarios": "#f4a76a",
    "literal, feet cut off": "#fad3bc",
    "default, held out": "#1f78b4",
    "default, unseen scenarios": "#8fbbd9",
    "default, feet cut off": "#c7dded",
}
Points = dict[str, tuple[float, float | None]]
Series = dict[str, Points]
_OTHERS = ("#1f78b4", "#66a61e", "#7570b3")


def draw(experiment: Experiment, samples: Samples) -> str | None:
    """Draw an experiment as an SVG data URL; None if there is nothing to draw."""
    if experiment.chart == "none":
        return None
    figure = (
        _lines(experiment.plotted[0], samples, experiment)
        if experiment.chart == "lines"
        else _bars(experiment.plotted, samples, experiment)
    )
    return "data:image/svg+xml;base64," + base64.b64encode(svg(figure, "peopleboy")).decode()


def _lines(column: str, samples: Samples, experiment: Experiment) -> Figure:
    """Draw a sweep: one curve each for the source and the trackers.

    The title of a sweep names the varied quantity after the comma.
    """
    figure, axes = svg_axes(6.0, 3.2)
    groups = list(dict.fromkeys([*(line.group for line in samples), *experiment.printed(column)]))
    groups.sort(key=lambda group: float(group.removesuffix(" %")))
    curves = {method: _ours(samples, column, method) for method in _names(samples)}
    curves[SOURCE] = experiment.printed(column)
    for method, points in curves.items():
        if not points:
            continue
        known = [group for group in groups if group in points]
        axes.errorbar(
            [groups.index(group) for group in known],
            [points[group][0] for group in known],
            [points[group][1] or 0.0 for group in known],
            label=method,
            color=_colour(method, 0),
            marker="o",
            markersize=4,
            capsize=3,
            linestyle="--" if method == SOURCE else "-",
        )
    axes.set_xticks(range(len(groups)), groups)
    axes.set_xlabel(experiment.title.split(", ", 1)[-1])
    axes.set_ylabel(f"{column} [%]")
    axes.set_ylim(bottom=max(0.0, axes.get_ylim()[0]))
    finish(axes)
    axes.legend(fontsize=8, frameon=False, ncols=4, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    return figure


def _bars(columns: Sequence[str], samples: Samples, experiment: Experiment) -> Figure:
    """Draw clusters of bars: all columns in one plot per group, or all groups in one plot per column."""
    groups = _groups(samples, columns, experiment)
    by_column = {column: _series(samples, column, experiment) for column in columns}
    plots, clusters = (groups, columns) if len(columns) > len(groups) else (columns, groups)
    figure = Figure(figsize=(6.0, 0.7 + 2.3 * len(plots)), layout="constrained")
    FigureCanvasSVG(figure)
    for number, title in enumerate(plots):
        axes = figure.add_subplot(len(plots), 1, number + 1)
        _cluster(axes, clusters, by_column[title] if plots is columns else _of_group(by_column, title))
        axes.set_title(title if len(plots) > 1 else "", fontsize=9, loc="left")
        axes.set_ylabel(columns[0] if "%" in columns[0] else "%")
        finish(axes)
        if number == 0:
            handles, labels = axes.get_legend_handles_labels()
            columns_of_names = 3 if len(labels) > 4 else 4
            figure.legend(
                handles, labels, fontsize=8, frameon=False, ncols=columns_of_names, loc="outside upper left"
            )
    return figure


def _groups(samples: Samples, columns: Sequence[str], experiment: Experiment) -> list[str]:
    """Return the printed and measured groups, in the source's order."""
    theirs = [group for column in columns for group in experiment.printed(column)]
    return list(dict.fromkeys([*theirs, *(line.group for line in samples)]))


def _series(samples: Samples, column: str, experiment: Experiment) -> Series:
    """Return a column's values by method, then by group; the source's come first."""
    ours = {method: _ours(samples, column, method) for method in _names(samples)}
    return {SOURCE: experiment.printed(column)} | ours


def _of_group(by_column: dict[str, Series], group: str) -> Series:
    """Return a group's values by method, then by column."""
    names = dict.fromkeys(method for series in by_column.values() for method in series)
    return {
        method: {
            c: series[method][group] for c, series in by_column.items() if group in series.get(method, {})
        }
        for method in names
    }


def _cluster(axes: Axes, groups: Sequence[str], series: Series) -> None:
    drawn = {method: points for method, points in series.items() if points}
    width = 0.8 / max(len(drawn), 1)
    for number, (method, points) in enumerate(drawn.items()):
        at = [groups.index(group) for group in points]
        axes.bar(
            np.array(at) + width * (number - (len(drawn) - 1) / 2),
            [mean for mean, _ in points.values()],
            0.92 * width,
            yerr=[spread or 0.0 for _, spread in points.values()],
            label=method,
            color=_colour(method, number),
            error_kw={"linewidth": 0.8},
        )
    axes.set_xticks(range(len(groups)), groups)
    axes.set_xlim(-0.6, len(groups) - 0.4)
    axes.set_ylim(0, 105)


def _ours(samples: Samples, column: str, method: str) -> Points:
    return {
        line.group: mean_and_spread(values[column])
        for line, values in samples.items()
        if line.method == method and column in values
    }


def _names(samples: Samples) -> list[str]:
    return list(dict.fromkeys(line.method for line in samples))


def _colour(method: str, number: int) -> str:
    return COLOURS.get(method, _OTHERS[(number - 1) % len(_OTHERS)])
