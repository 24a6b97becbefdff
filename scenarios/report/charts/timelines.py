"""The timelines of a page: what there was to be seen of each person, and what the trackers had."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import groupby
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
from peopleboy.scenarios.report.charts.svg import INK, LINE, SOFT, inline, lettered, new_figure, says
from peopleboy.scenarios.report.columns import Column, are_same_scene
from peopleboy.scenarios.report.findings.sentences import listed, seconds, spoken
from peopleboy.scenarios.report.findings.spans import Floats, settle, spans
from peopleboy.scenarios.report.findings.story import Hold, PersonView, Story
from peopleboy.scenarios.report.findings.summary import RunFindings
from peopleboy.tracker.evaluation.occlusion_scores import TOTAL_ENDS, TOTAL_STARTS

ASIDE: Final = ", not counted (too near or too far away)"
_LOOKS: Final[dict[str, dict[str, Any]]] = {
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
_STRIPES: Final = {"partly": ("#8ba3ba", -1.0), "missed": ("#d55e00", 1.0)}  # colour, and 1 if they fall
_HIDDEN: Final = {PersonView.PARTLY: "partly", PersonView.WHOLLY: "wholly"}
_CHANGE: Final = "#a83c00"
_EDGES: Final = ("", "-", "--")  # of a track's bar; nothing for no line

# All in points. A page shows the wide drawing on a desk and on paper, the narrow one on a phone.
_WIDE, _NARROW, _LABELS, _RIGHT = 620.0, 270.0, 46.0, 10.0
_ROW, _BAR, _ABOVE, _AXIS, _BESIDE, _STRIPE = 18.0, 14.0, 4.0, 16.0, 7.0, 4.0


class Look(NamedTuple):
    """How a stretch of a timeline looks."""

    kind: str
    words: str  # said when it is pointed at
    text: str = ""  # written in it where there is room
    track: int = 0  # whose colour it has


@dataclass(frozen=True, slots=True)
class TimelineRow:
    """Stretches in one row: start, end [s] and look; and marks: when [s], and what they say."""

    label: str
    bars: tuple[tuple[float, float, Look], ...]
    marks: tuple[tuple[float, str], ...] = ()

    @property
    def words(self) -> str:
        """The same in words."""
        told = [f"{start:.1f} to {end:.1f} s {look.words}" for start, end, look in self.bars]
        return f"{self.label}: " + "; ".join(told + [words for _, words in self.marks])


class PersonTimeline(NamedTuple):
    """The rows of one person, or of the robot, as drawn, and when the person was hidden."""

    name: str
    drawn: Markup
    hidden: str


def timelines(columns: Sequence[Column]) -> list[tuple[str, list[PersonTimeline]]]:
    """Draw the timelines of each run, under its title; but runs of the same scene share one."""
    if len(columns) > 1 and are_same_scene(columns) and _is_same_world(columns):
        return [(columns[0].found.run.title, _timeline(columns))]
    return [(column.label, _timeline([column])) for column in columns if column.is_single]


def truth_row(found: RunFindings, person: Story) -> TimelineRow:
    """What there was to be seen of a person."""

    def look(view: int, is_counted: bool, hider: str) -> Look | None:
        aside, by = "" if is_counted else ASIDE, f"by {spoken(hider)}" if hider else ""
        if view == PersonView.SEEN:
            return Look("seen", "seen", "seen") if is_counted else Look("uncounted", f"seen{aside}")
        kind = _HIDDEN.get(PersonView(view))
        return None if kind is None else Look(kind, f"{kind} hidden {by}".rstrip() + aside, by)

    looks = map(look, person.view.tolist(), person.is_counted.tolist(), _settled_hiders(person))
    return TimelineRow("truth", _bars(found, looks))


def track_row(found: RunFindings, person: Story) -> TimelineRow:
    """What the tracker had of a person."""

    def look(hold: int, number: int) -> Look | None:
        others = {
            Hold.ADRIFT: Look("adrift", "its box lies elsewhere"),
            Hold.MISSED: Look("missed", "not found"),
        }
        return (
            Look("on", f"number {number}", str(number), number) if hold == Hold.ON else others.get(Hold(hold))
        )

    marks = [
        (
            change.time_s,
            f"{change.time_s:.1f} s: number {change.old} becomes {change.new}"
            + (f", which was {spoken(change.taken_from)}'s" if change.taken_from else ""),
        )
        for change in found.changes
        if change.person == person.name
    ]
    changed = {time_s for time_s, _ in marks}
    marks += [
        (one.time_s, f"{one.time_s:.1f} s: has number {one.number}, which was {spoken(one.from_person)}'s")
        for one in found.passings
        if one.to_person == person.name and one.time_s not in changed
    ]
    looks = map(look, person.hold.tolist(), person.track.tolist())
    return TimelineRow("track", _bars(found, looks), tuple(sorted(marks)))


def stray_row(found: RunFindings) -> TimelineRow:
    """Tracks that never lay on anybody."""
    bars = []
    for stray in found.strays:
        look = Look("stray", f"number {stray.track}", str(stray.track))
        bars += _bars(found, (look if is_shown else None for is_shown in found.shown[stray.track]))
    return TimelineRow("on nobody", tuple(bars))


def mode_row(found: RunFindings) -> TimelineRow:
    """What the robot did, if that was more than one thing."""
    modes = found.files.robot["mode"].to_pylist()
    names = list(dict.fromkeys(modes))
    why, reason, looks = {line.frame: line.why for line in found.run.events if line.kind == "mode"}, "", []
    for frame, mode in enumerate(modes, start=1):
        reason = why.get(frame, reason)
        looks.append(Look(f"mode{names.index(mode) % 4}", f"{mode}{': ' if reason else ''}{reason}", mode))
    return TimelineRow("robot", _bars(found, looks) if len(names) > 1 else ())


def hidden_words(found: RunFindings, person: Story) -> str:
    """Say when the person was hidden, by whom, how much, and for how long wholly."""
    rate, told = found.run.rate_hz, []
    for span in spans(np.isin(person.view, tuple(_HIDDEN))):
        if span.value:
            here = slice(span.start, span.end)
            by = listed([spoken(name) for name in dict.fromkeys(person.hider[here]) if name])
            wholly_s = _wholly_hidden(person.occluded[here]) / rate
            how = (
                f"wholly for {seconds(wholly_s)}"
                if wholly_s
                else f"to {np.nanmax(person.occluded[here]):.0%}"
            )
            when = f"{'in all ' if wholly_s else ''}{span.start / rate:.1f} to {seconds(span.end / rate)}"
            told.append(f"{how}{' by ' if by else ''}{by} ({when})")
    return f"Hidden {', '.join(told)}." if told else ""


def _wholly_hidden(occluded: Floats) -> int:
    """Count frames as the scores of occlusions do: from the first that is wholly hidden on."""
    starts = np.flatnonzero(occluded > TOTAL_STARTS)
    return int((occluded[starts[0] :] >= TOTAL_ENDS).sum()) if len(starts) else 0


@lettered
def swatch(kind: str, track: int = 0) -> Markup:
    """Draw a bar of a kind for the key, or a track's."""
    figure = new_figure(22.0, 11.0)
    axes = figure.add_axes((0.02, 0.04, 0.96, 0.92))
    axes.set(xlim=(0.0, 1.0), ylim=(11.0, 0.0))
    axes.set_axis_off()
    _draw_bar(axes, (0.0, 1.0), Look(kind, "", track=track), 0.0, 11.0, 22.0)
    return inline(figure, f"key {kind} {track}")


def rgb(number: int) -> str:
    """The colour of a track, for a page."""
    return "#{:02x}{:02x}{:02x}".format(*track_colour(number))


def track_edges(number: int) -> tuple[str, str]:
    """Styles of the lines along a track's bar, below and above: with its colour, they make 54 looks."""
    lap = (number - 1) // TRACK_COLOURS
    return _EDGES[lap % len(_EDGES)], _EDGES[lap // len(_EDGES) % len(_EDGES)]


def _bars(found: RunFindings, looks: Iterator[Look | None] | Sequence[Look | None]) -> Any:
    """Make a bar of every longest run of frames that look alike."""
    bars, start, rate = [], 0, found.run.rate_hz
    for look, alike in groupby(looks):
        end = start + len(list(alike))
        if look is not None:
            bars.append((start / rate, end / rate, look))
        start = end
    return tuple(bars)


def _settled_hiders(person: Story) -> list[str]:
    """Who hides the person at each frame, without those who do so for a glimpse."""
    hiders = list(person.hider)
    for stretch in spans(person.view * 2 + ~person.is_counted):
        here = hiders[stretch.start : stretch.end]
        names = list(dict.fromkeys(here))
        codes = settle(np.array([names.index(name) + 1 for name in here], np.int64), 3)
        most = person.hider_in(stretch.start, stretch.end)
        hiders[stretch.start : stretch.end] = [names[code - 1] if code else most for code in codes]
    return hiders


def _timeline(columns: Sequence[Column]) -> list[PersonTimeline]:
    first = columns[0].found

    def named(row: TimelineRow, column: Column) -> TimelineRow:
        return row if len(columns) == 1 else replace(row, label=column.label)

    groups = []
    for person in first.people:
        tracks = [named(track_row(c.found, c.found.called(person.name)), c) for c in columns]
        groups.append((spoken(person.name), [truth_row(first, person), *tracks], hidden_words(first, person)))
    for name, make in (("Boxes on nobody", stray_row), ("The robot", mode_row)):
        rows = [named(make(column.found), column) for column in columns]
        groups.append((name, [row for row in rows if row.bars], ""))
    groups = [group for group in groups if group[1]]
    people = []
    for number, (name, rows, hidden) in enumerate(groups, start=1):
        drawn = draw_rows(first, rows, name, columns[0].label, has_axis=number == len(groups))
        people.append(PersonTimeline(name, drawn, hidden))
    return people


def _is_same_world(columns: Sequence[Column]) -> bool:
    """Whether everybody was seen alike in all runs: the robot stood or drove the same way."""
    views = [[(person.id, person.view.tolist()) for person in column.found.people] for column in columns]
    return all(of_run == views[0] for of_run in views)


def draw_rows(
    found: RunFindings, rows: Sequence[TimelineRow], name: str, label: str, *, has_axis: bool
) -> Markup:
    """Draw the rows of somebody or something of a run, wide for desks and narrow for phones."""
    duration_s = found.run.frames / found.run.rate_hz
    words = f"{name}, {'. '.join(row.words for row in rows)}"
    wide, narrow = (
        inline(_figure_of(rows, duration_s, width, has_axis=has_axis), f"{label}, {name}, {width}", words)
        for width in (_WIDE, _NARROW)
    )
    return Markup('<div class="wide">{}</div><div class="narrow">{}</div>').format(wide, narrow)


@lettered
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
        says(mark, words)


def _draw_bar(
    axes: Axes, span_s: tuple[float, float], look: Look, top: float, height: float, points_per_s: float
) -> None:
    start, end = span_s
    style = {"fc": rgb(look.track)} if look.track else _LOOKS[look.kind]
    box = Rectangle((start, top), end - start, height, zorder=2, clip_on=False, **({"lw": 0.0} | style))
    says(axes.add_patch(box), f"{start:.1f} to {end:.1f} s {look.words}")
    if look.kind in _STRIPES:
        colour, falls = _STRIPES[look.kind]
        across, down = _diagonals((end - start) * points_per_s, height)
        x, y = start + across / points_per_s, top + height / 2.0 + falls * down
        axes.plot(x, y, color=colour, lw=1.4, solid_capstyle="butt", zorder=2.5)
    for edge, share in zip(track_edges(max(look.track, 1)), (0.93, 0.07), strict=True):
        if edge:
            axes.plot(span_s, [top + share * height] * 2, edge, color=INK, lw=0.14 * height, zorder=3)


def _diagonals(width: float, height: float) -> tuple[Floats, Floats]:
    """Lines that fall at 45 degrees through a box: from its left, and from its middle down, with gaps of NaN.

    They are no pattern of the page, which browsers print as large images.
    """
    starts = np.arange(_STRIPE - height, width, _STRIPE)
    left, right = np.maximum(starts, 0.0), np.minimum(starts + height, width)
    across = np.stack([left, right, np.full(len(starts), np.nan)], axis=1)
    return across.ravel(), (across - starts[:, None] - height / 2.0).ravel()


@cache
def _width_pt(text: str) -> float:
    return float(TextPath((0.0, 0.0), text, size=8.5).get_extents().width)
