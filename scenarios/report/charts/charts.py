"""Timelines and curves as what a page needs to draw them: places in per cent, so that they fit any width."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from peopleboy.scenarios.drawing.palette import TRACK_COLOURS, track_colour
from peopleboy.scenarios.report.findings.errors import Curve
from peopleboy.scenarios.report.findings.sentences import listed, seconds, spoken
from peopleboy.scenarios.report.findings.spans import settle, spans
from peopleboy.scenarios.report.findings.story import Hold, Sight, Story, present_tracks
from peopleboy.scenarios.report.findings.summary import Outcome

# Of text in a bar: the room that a letter takes, and that beside the text; and the least width of a timeline.
_LETTER_PX, _BESIDE_PX = 8.0, 7.0
_PHONE_PX, _DESK_PX = 250.0, 510.0
_SERIES = ("#0072b2", "#d55e00", "#009e73", "#a8327a")  # Okabe and Ito; dark enough for lines on white
_DASHES = ("none", "6 3", "2 3", "8 3 2 3")
_EDGES = ("", "none", "4 3")  # dashes of the lines along bars; nothing for no line
_EDGES_AT_PX = (18.5, 1.5)  # below and above
_TICKS = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0)
_MOST_TICKS = 7


@dataclass(frozen=True, slots=True)
class Bar:
    """One stretch of a timeline.

    Attributes:
        kind: names its look.
        left, width: [%] of the time.
        text: written in it; empty if it is too short for that.
        title: what it says when it is pointed at.
        colour: of what is drawn in it.
        edges: heights [px] and dashes of lines along it, which tell tracks of one colour apart.
        is_roomy: whether the text fits on a desk only.
    """

    kind: str
    left: float
    width: float
    text: str
    title: str
    colour: str = ""
    edges: tuple[tuple[float, str], ...] = ()
    is_roomy: bool = False


@dataclass(frozen=True, slots=True)
class Lane:
    """One row of bars, and what it says in words for those who do not see it."""

    label: str
    bars: tuple[Bar, ...]
    marks: tuple[Bar, ...] = ()

    @property
    def summary(self) -> str:
        """All bars in words."""
        return f"{self.label}: " + "; ".join(bar.title for bar in self.bars if bar.title)


@dataclass(frozen=True, slots=True)
class Tick:
    """A label at a place [%] on an axis."""

    at: float
    label: str


@dataclass(frozen=True, slots=True)
class Line:
    """A curve as points in per cent from the left and from the top, each with its spread and words."""

    label: str
    colour: str
    dash: str
    points: tuple[tuple[float, float, float, float, str], ...]

    @property
    def pieces(self) -> list[tuple[float, float, float, float]]:
        """The straight pieces x, y to x, y."""
        ends = zip(self.points[:-1], self.points[1:], strict=True)
        return [(a[0], a[1], b[0], b[1]) for a, b in ends]


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves in one frame."""

    title: str
    x_label: str
    x_ticks: tuple[Tick, ...]
    y_ticks: tuple[Tick, ...]
    lines: tuple[Line, ...]

    @property
    def summary(self) -> str:
        """All points in words."""
        return f"{self.title}. " + ". ".join(
            f"{line.label}: " + "; ".join(point[4] for point in line.points) for line in self.lines
        )


def time_ticks(duration_s: float) -> list[Tick]:
    """Give whole times along a timeline."""
    step = next((step for step in _TICKS if duration_s / step <= _MOST_TICKS), _TICKS[-1])
    count = int(duration_s / step) + 1
    return [Tick(100.0 * k * step / duration_s, f"{k * step:g} s") for k in range(count)]


def truth_lane(outcome: Outcome, story: Story) -> Lane:
    """What there was to be seen of a person."""
    keys = story.sight * 2 + ~story.is_counted
    bars = []
    for span in spans(np.asarray(keys, np.int64)):
        sight, is_counted = Sight(span.value // 2), span.value % 2 == 0
        if sight is not Sight.AWAY:
            bars += _sight_bars(outcome, story, sight, span.start, span.end, is_counted=is_counted)
    return Lane("truth", tuple(bars))


def _sight_bars(
    outcome: Outcome, story: Story, sight: Sight, start: int, end: int, *, is_counted: bool
) -> list[Bar]:
    """One stretch of equal sight; what is hidden is cut where somebody else begins to hide the person."""
    aside = "" if is_counted else ", not counted (nearer than 3 m or farther than 10 m)"
    if sight is Sight.SEEN:
        kind, text = ("seen", "seen") if is_counted else ("uncounted", "")
        return [_bar(outcome, kind, start, end, text, f"seen{aside}")]
    names = list(dict.fromkeys(story.hider[start:end]))
    codes = settle(np.array([names.index(name) + 1 for name in story.hider[start:end]], np.int64), 3)
    how = "wholly hidden" if sight is Sight.WHOLLY else "partly hidden"
    kind = "wholly" if sight is Sight.WHOLLY else "partly"
    bars = []
    for span in spans(codes):
        who = names[span.value - 1] if span.value else story.hider_in(start, end)
        by = f" by {spoken(who)}" if who else ""
        title = f"{how}{by}{aside}"
        bars.append(_bar(outcome, kind, start + span.start, start + span.end, by.strip(), title))
    return bars


def hidden_words(outcome: Outcome, story: Story) -> str:
    """Say when the person was hidden, by whom, and how much."""
    rate, words = outcome.run.rate_hz, []
    for span in spans((story.sight == Sight.PARTLY) | (story.sight == Sight.WHOLLY)):
        if span.value:
            here = slice(span.start, span.end)
            by = listed([spoken(name) for name in dict.fromkeys(story.hider[here]) if name])
            most = np.nanmax(story.occluded[here])
            how = "wholly" if (story.sight[here] == Sight.WHOLLY).any() else f"to {most:.0%}"
            words.append(
                f"{how}{' by ' if by else ''}{by} ({span.start / rate:.1f} to {seconds(span.end / rate)})"
            )
    return f"Hidden {', '.join(words)}." if words else ""


def track_lane(outcome: Outcome, story: Story) -> Lane:
    """What the tracker had of a person."""
    bars = []
    for span in spans(np.asarray(story.hold * 1_000_000 + story.track)):
        hold, number = Hold(span.value // 1_000_000), span.value % 1_000_000
        if hold is Hold.ON:
            bars.append(_bar(outcome, "on", span.start, span.end, str(number), f"number {number}", number))
        elif hold is Hold.ADRIFT:
            bars.append(_bar(outcome, "adrift", span.start, span.end, "", "its box lies elsewhere"))
        elif hold is Hold.MISSED:
            bars.append(_bar(outcome, "missed", span.start, span.end, "", "not found"))
    marks = tuple(
        Bar(
            "change",
            100.0 * (change.first_frame - 1) / outcome.run.frames,
            0.0,
            "",
            f"{change.time_s:.1f} s: number {change.old} becomes {change.new}"
            + (f", which was {spoken(change.taken_from)}'s" if change.taken_from else ""),
        )
        for change in outcome.changes
        if change.person == story.name
    )
    return Lane("track", tuple(bars), marks)


def stray_lane(outcome: Outcome) -> Lane | None:
    """Tracks that never lay on anybody."""
    shown = present_tracks(outcome.run)
    bars = []
    for stray in outcome.strays:
        for span in spans(settle(shown[stray.track].astype(np.int64), 1)):
            if span.value:
                number = stray.track
                bars.append(_bar(outcome, "stray", span.start, span.end, str(number), f"number {number}"))
    return Lane("on nobody", tuple(bars)) if bars else None


def mode_lane(outcome: Outcome) -> Lane | None:
    """What the robot did, if that was more than one thing."""
    modes = outcome.run.robot["mode"].to_pylist()
    names = list(dict.fromkeys(modes))
    if len(names) < 2:
        return None
    why = {line.frame: line.why for line in outcome.run.events if line.kind == "mode"}
    codes = np.array([names.index(mode) for mode in modes], np.int64)
    bars = []
    for span in spans(codes):
        reason = why.get(span.start + 1, "")
        title = f"{names[span.value]}{': ' if reason else ''}{reason}"
        bars.append(_bar(outcome, f"mode{span.value % 4}", span.start, span.end, names[span.value], title))
    return Lane("robot", tuple(bars))


def _bar(outcome: Outcome, kind: str, start: int, end: int, text: str, title: str, track: int = 0) -> Bar:
    run = outcome.run
    width = 100.0 * (end - start) / run.frames
    needed_px = len(text) * _LETTER_PX + _BESIDE_PX
    return Bar(
        kind=kind,
        left=100.0 * start / run.frames,
        width=width,
        text=text if needed_px <= width / 100.0 * _DESK_PX else "",
        title=f"{start / run.rate_hz:.1f} to {end / run.rate_hz:.1f} s {title}",
        colour=rgb(track) if track else "",
        edges=track_edges(track) if track else (),
        is_roomy=needed_px > width / 100.0 * _PHONE_PX,
    )


def track_edges(number: int) -> tuple[tuple[float, str], ...]:
    """Give the lines along the bars of a track: with its colour, they make 54 looks."""
    lap = (number - 1) // TRACK_COLOURS
    styles = (_EDGES[lap % len(_EDGES)], _EDGES[lap // len(_EDGES) % len(_EDGES)])
    return tuple((y, dash) for y, dash in zip(_EDGES_AT_PX, styles, strict=True) if dash)


def rgb(number: int) -> str:
    """The colour of a track, for a page."""
    return "#{:02x}{:02x}{:02x}".format(*track_colour(number))


def chart(
    title: str,
    curves: Sequence[Curve],
    x_label: str,
    x_span: tuple[float, float],
    x_ticks: Sequence[float],
    y_top: float | None,
    unit: str,
) -> Chart:
    """Lay out curves; y goes from 0 to `y_top`, or as far as the data go.

    Args:
        title: of the chart.
        curves: what to draw.
        x_label: of the axis.
        x_span: its ends.
        x_ticks: what is labelled on it.
        y_top: of the other axis; None for the data's largest.
        unit: of the figures.
    """
    highest = max(
        (p.mean + (0.0 if math.isnan(p.sd) else p.sd) for c in curves for p in c.points), default=1.0
    )
    top = _round_up(highest) if y_top is None else y_top
    low, high = x_span

    def across(x: float) -> float:
        return 100.0 * (x - low) / (high - low)

    def down(y: float) -> float:
        return 100.0 * (1.0 - min(max(y, 0.0), top) / top)

    lines = []
    for number, one in enumerate(curves):
        points = []
        for p in one.points:
            sd = 0.0 if math.isnan(p.sd) else p.sd
            spread = f" ± {p.sd:.1f}" if sd else ""
            words = f"at {p.x:.2g}: {p.mean:.1f}{spread} {unit} ({p.frames} boxes)"
            points.append((across(p.x), down(p.mean), down(p.mean + sd), down(p.mean - sd), words))
        colour, dash = _SERIES[number % len(_SERIES)], _DASHES[number % len(_DASHES)]
        lines.append(Line(one.label, colour, dash, tuple(points)))
    return Chart(
        title,
        x_label,
        tuple(Tick(across(x), f"{x:g}") for x in x_ticks),
        tuple(Tick(down(top * k / 4.0), f"{top * k / 4.0:g}") for k in range(5)),
        tuple(lines),
    )


def series_colour(number: int) -> str:
    """The colour in which a page shows its n-th run or tracker."""
    return _SERIES[number % len(_SERIES)]


def _round_up(value: float) -> float:
    """The next of 1, 2, 4, 8 times a power of ten, so that quarters are short numbers."""
    power = 10.0 ** math.floor(math.log10(value)) if value > 0.0 else 1.0
    return next(step * power for step in (1.0, 2.0, 4.0, 8.0, 10.0) if step * power >= value)
