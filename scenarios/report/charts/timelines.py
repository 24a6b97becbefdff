"""Draw the timelines of a page: people, robot and moved objects over the time of a run."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from textwrap import fill
from typing import Any, Final, NamedTuple

import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.textpath import TextPath
from matplotlib.ticker import MaxNLocator

from peopleboy.scenarios.drawing.palette import TRACK_COLOURS, track_colour
from peopleboy.scenarios.report.charts.timeline_rows import (
    BarStyle,
    TimelineRow,
    false_track_row,
    hidden_words,
    mode_row,
    thing_rows,
    track_row,
    truth_row,
)
from peopleboy.scenarios.report.columns import Column, are_same_scene
from peopleboy.scenarios.report.findings.histories import (
    Floats,
)
from peopleboy.scenarios.report.findings.run_findings import RunFindings
from peopleboy.scenarios.report.findings.sentences import spoken
from peopleboy.scenarios.report.page_parts import INK, LINE, SOFT, inline, new_figure, set_tooltip, svg_style

_APPEARANCES: Final[dict[str, dict[str, Any]]] = {
    "seen": {"fc": "#cfdce8"},
    "uncounted": {"fc": "#f1f4f7", "ec": "#b9c4cf", "lw": 0.8},
    "partly": {"fc": "#dfe7ef"},
    "wholly": {"fc": "#3b4654"},
    "adrift": {"fc": "#ffffff", "ec": "#7a6a00", "lw": 1.1, "ls": (0, (2.2, 1.4))},
    "missed": {"fc": "#ffffff", "ec": "#d55e00", "lw": 0.8},
    "stray": {"fc": "#f2d4c2", "ec": "#a83c00", "lw": 0.8},
    "stands": {"fc": "#eef1f4", "ec": "#b9c4cf", "lw": 0.8},
    "mode0": {"fc": "#d8dee6"},
    "mode1": {"fc": "#bcd6c9"},
    "mode2": {"fc": "#e6d7ae"},
    "mode3": {"fc": "#d9c7de"},
}
_STRIPES: Final = {"partly": ("#8ba3ba", -1.0), "missed": ("#d55e00", 1.0)}  # colour, and 1 for hatching
_CHANGE: Final = "#a83c00"
_EDGES: Final = ("", "-", "--")  # of a track's bar; nothing for no line
# All in points. A page shows the wide drawing on screens and paper, and the narrow one on phones.
_WIDE, _NARROW, _LABELS, _RIGHT = 620.0, 270.0, 46.0, 10.0
_ROW, _BAR, _ABOVE, _AXIS, _BESIDE, _STRIPE = 18.0, 14.0, 4.0, 16.0, 7.0, 4.0


class PersonTimeline(NamedTuple):
    """The drawn rows of one person or the robot, and a text about occlusions of the person."""

    name: str
    drawn: Markup
    hidden: str


def timelines(columns: Sequence[Column]) -> list[tuple[str, list[PersonTimeline]]]:
    """Draw the timelines of each run, with its title; runs of the same scene share one."""
    if len(columns) > 1 and are_same_scene(columns) and _is_same_world(columns):
        return [(columns[0].found.run.title, _timeline(columns))]
    return [(column.label, _timeline([column])) for column in columns if column.is_single]


@svg_style
def swatch(kind: str, track: int = 0) -> Markup:
    """Draw a bar of a kind, or of a track, for the legend."""
    figure = new_figure(22.0, 11.0)
    axes = figure.add_axes((0.02, 0.04, 0.96, 0.92))
    axes.set(xlim=(0.0, 1.0), ylim=(11.0, 0.0))
    axes.set_axis_off()
    _draw_bar(axes, (0.0, 1.0), BarStyle(kind, "", track=track), 0.0, 11.0, 22.0)
    return inline(figure, f"key {kind} {track}")


def rgb(number: int) -> str:
    """Return the colour of a track on a page."""
    return "#{:02x}{:02x}{:02x}".format(*track_colour(number))


def track_edges(number: int) -> tuple[str, str]:
    """Styles of the lines along the lower and upper edge of a track's bar; with colours, 54 combinations."""
    lap = (number - 1) // TRACK_COLOURS
    return _EDGES[lap % len(_EDGES)], _EDGES[lap // len(_EDGES) % len(_EDGES)]


def _timeline(columns: Sequence[Column]) -> list[PersonTimeline]:
    first = columns[0].found

    def named(row: TimelineRow, column: Column) -> TimelineRow:
        return row if len(columns) == 1 else replace(row, label=column.label)

    groups = []
    for person in first.people:
        tracks = [named(track_row(c.found, c.found.called(person.name)), c) for c in columns]
        groups.append((spoken(person.name), [truth_row(first, person), *tracks], hidden_words(first, person)))
    for name, make in (("False tracks", false_track_row), ("The robot", mode_row)):
        rows = [named(make(column.found), column) for column in columns]
        groups.append((name, [row for row in rows if row.bars], ""))
    groups = [group for group in groups if group[1]]
    people = []
    for number, (name, rows, hidden) in enumerate(groups, start=1):
        drawn = draw_rows(first, rows, name, columns[0].label, has_axis=number == len(groups))
        people.append(PersonTimeline(name, drawn, hidden))
    return people


def _is_same_world(columns: Sequence[Column]) -> bool:
    """Return whether people's visibility is the same in all runs, since the robot had the same path."""
    views = [[(person.id, person.view.tolist()) for person in column.found.people] for column in columns]
    return all(of_run == views[0] for of_run in views)


def draw_rows(
    found: RunFindings, rows: Sequence[TimelineRow], name: str, label: str, *, has_axis: bool
) -> Markup:
    """Draw rows of a run, in a wide version for screens and a narrow one for phones."""
    duration_s = found.run.frames / found.run.rate_hz
    words = f"{name}, {'. '.join(row.words for row in rows)}"
    wide, narrow = (
        inline(_figure_of(rows, duration_s, width, has_axis=has_axis), f"{label}, {name}, {width}", words)
        for width in (_WIDE, _NARROW)
    )
    return Markup('<div class="wide">{}</div><div class="narrow">{}</div>').format(wide, narrow)


@svg_style
def _figure_of(rows: Sequence[TimelineRow], duration_s: float, width: float, *, has_axis: bool) -> Figure:
    foot = _AXIS if has_axis else 1.0
    tall, across = len(rows) * _ROW, width - _LABELS - _RIGHT
    height = _ABOVE + tall + foot
    figure = new_figure(width, height)
    axes = figure.add_axes((_LABELS / width, foot / height, across / width, tall / height))
    axes.set(xlim=(0.0, duration_s), ylim=(tall, 0.0), frame_on=False, yticks=())
    axes.xaxis.set_major_locator(MaxNLocator(7 if width == _WIDE else 4, steps=[1, 2, 5, 10]))
    axes.xaxis.set_major_formatter("{x:g} s")
    axes.tick_params(length=3.0 if has_axis else 0.0, labelbottom=has_axis)
    axes.grid(axis="x", color=LINE, lw=0.6)
    axes.set_axisbelow(True)
    for number, row in enumerate(rows):
        _draw_row(axes, row, number * _ROW, across / duration_s)
    return figure


def _draw_row(axes: Axes, row: TimelineRow, top: float, points_per_s: float) -> None:
    middle = top + _ROW / 2.0
    label = fill(row.label, 9, max_lines=2, placeholder="\u2026")
    beside: dict[str, Any] = {"textcoords": "offset points", "va": "center_baseline"}
    axes.annotate(label, (0.0, middle), (-4.0, 0.0), size=7.5, color=SOFT, ha="right", **beside)
    axes.axhline(middle, color=LINE, lw=0.8)
    for start, end, look in row.bars:
        _draw_bar(axes, (start, end), look, top + (_ROW - _BAR) / 2.0, _BAR, points_per_s)
        if look.text and (end - start) * points_per_s > _width_pt(look.text) + _BESIDE:
            plate = {"fc": "#ffffff", "alpha": 0.85, "lw": 0.0, "pad": 1.2} if look.kind == "partly" else None
            colour = "#ffffff" if look.kind == "wholly" else INK
            axes.annotate(
                look.text, (start, middle), (3.0, 0.0), color=colour, bbox=plate, zorder=3, **beside
            )
    for time_s, words in row.marks:
        axes.plot([time_s] * 2, [top, top + _ROW], color=_CHANGE, lw=1.5, clip_on=False, zorder=4)
        (mark,) = axes.plot(time_s, top, "v", ms=5.5, mec="none", mfc=_CHANGE, clip_on=False, zorder=4)
        set_tooltip(mark, words)


def _draw_bar(
    axes: Axes, span_s: tuple[float, float], look: BarStyle, top: float, height: float, points_per_s: float
) -> None:
    start, end = span_s
    style = {"fc": rgb(look.track)} if look.track else _APPEARANCES[look.kind]
    box = Rectangle((start, top), end - start, height, zorder=2, clip_on=False, **({"lw": 0.0} | style))
    set_tooltip(axes.add_patch(box), f"{start:.1f} to {end:.1f} s {look.words}")
    if look.kind in _STRIPES:
        colour, falls = _STRIPES[look.kind]
        across, down = _diagonals((end - start) * points_per_s, height)
        x, y = start + across / points_per_s, top + height / 2.0 + falls * down
        axes.plot(x, y, color=colour, lw=1.4, solid_capstyle="butt", zorder=2.5)
    for edge, share in zip(track_edges(max(look.track, 1)), (0.93, 0.07), strict=True):
        if edge:
            axes.plot(span_s, [top + share * height] * 2, edge, color=INK, lw=0.14 * height, zorder=3)


def _diagonals(width: float, height: float) -> tuple[Floats, Floats]:
    """Return hatching of a box: lines that fall at 45 degrees, separated by NaN.

    An SVG pattern would be simpler, but browsers print patterns as large images.
    """
    starts = np.arange(_STRIPE - height, width, _STRIPE)
    left, right = np.maximum(starts, 0.0), np.minimum(starts + height, width)
    across = np.stack([left, right, np.full(len(starts), np.nan)], axis=1)
    return across.ravel(), (across - starts[:, None] - height / 2.0).ravel()


@cache
def _width_pt(text: str) -> float:
    return float(TextPath((0.0, 0.0), text, size=8.5).get_extents().width)


def draw_things(found: RunFindings, label: str) -> Markup:
    """Draw a row for each object with events; nothing if there is none."""
    rows = thing_rows(found)
    return draw_rows(found, rows, "Things", label, has_axis=True) if rows else Markup("")
