"""The page: everything about one run, or about several side by side, in one file that needs nothing else."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import jinja2
from PIL import Image

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.contact_sheet import read_tiles
from peopleboy.scenarios.drawing.overlay import encode_jpeg
from peopleboy.scenarios.drawing.palette import TRACK_COLOURS
from peopleboy.scenarios.report.charts.charts import Chart, chart, track_edges
from peopleboy.scenarios.report.charts.thermal_stills import Shown, show_frames
from peopleboy.scenarios.report.charts.timelines import timelines
from peopleboy.scenarios.report.charts.trajectories import draw_trajectories
from peopleboy.scenarios.report.columns import Column, are_same_scene, lacking, read_columns
from peopleboy.scenarios.report.figure_tables import all_lines, drive_lines, number, plain_lines
from peopleboy.scenarios.report.findings.errors import (
    DISTANCES_M,
    VISIBLE,
    curve,
    distance,
    found_share,
    offset,
    visible,
)
from peopleboy.scenarios.report.findings.sentences import listed, seconds, spoken
from peopleboy.scenarios.report.findings.summary import Outcome, headline
from peopleboy.scenarios.report.findings.worst_moments import BadMoment, common_frames, worst_moments
from peopleboy.scenarios.report.page_file import check_place, write_page
from peopleboy.tracker.evaluation.occlusion_scores import LENGTHS_S, by_length

HERE = Path(__file__).parent
_JPEG_QUALITY = 80
_TILE_QUALITY = 72
_MOMENTS = 6  # of one run; of two side by side, each has half as many
_RUNS_SHOWN = 4  # of many runs, of which the worst moment is shown
_NAMED = 4  # scenarios in a title
_LONGEST_TABLE = 40  # runs that are listed one by one


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture inside the page: its data address, and what it shows in words."""

    address: str
    words: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Shot:
    """One instant of a moment: when, and the picture of each run that is shown."""

    time_s: float
    pictures: tuple[tuple[str, Picture], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """A bad moment with its pictures, and whose it is."""

    moment: BadMoment
    whose: str
    shots: tuple[Shot, ...]
    origin: str


def write_report(paths: Sequence[Path], out: Path) -> list[str]:
    """Write the page about the runs in these folders.

    Args:
        paths: as for `read_columns`.
        out: the page; nothing is written if anything is wrong.

    Returns:
        What the page lacks and why, a line each.

    Raises:
        BadInput: there is no complete run, or the page cannot be written, or not there.
    """
    check_place(out)
    columns = read_columns(paths)
    write_page(render(columns), out)
    return lacking(columns)


def render(columns: Sequence[Column]) -> str:
    """Write the page as HTML."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "spoken": spoken,
        "number": number,
        "headline": headline,
        "seconds": seconds,
        "edges": track_edges,
    }
    singles = [column for column in columns if column.is_single]
    return environment.get_template("page.html.jinja").render(
        columns=columns,
        title=_title(columns),
        repeated=_first_repeated(singles),
        lacking=lacking(columns),
        singles=singles,
        crowds=[column for column in columns if not column.is_single],
        sheets=[(column.label, _tiles(column)) for column in singles],
        timelines=timelines(columns),
        scenes=_scenes(columns),
        plain=plain_lines(columns),
        figures=all_lines(columns),
        drives=[(name, drive_lines(columns, name)) for name in ("following", "corridor")],
        charts=_charts(columns),
        plans=[(column.label, draw_trajectories(column.outcomes[0])) for column in singles],
        lengths=_lengths(columns),
        has_modes=any(line.kind == "mode" and line.frame > 1 for c in singles for line in c.run.events),
        most_runs=_LONGEST_TABLE,
        settings=[(column.label, _settings(column)) for column in columns],
    )


def _title(columns: Sequence[Column]) -> str:
    """Name the scenes: scenario and seed of single runs, else the scenarios and how many runs there are."""
    if all(column.is_single for column in columns):
        return listed(list(dict.fromkeys(column.run.name for column in columns)))
    outcomes = [outcome for column in columns for outcome in column.outcomes]
    names = list(dict.fromkeys(str(outcome.run.about["scenario"]) for outcome in outcomes))
    shown = listed(names) if len(names) <= _NAMED else f"{len(names)} scenarios"
    return f"{shown}: {len(outcomes)} runs"


def _first_repeated(columns: Sequence[Column]) -> int:
    """The first number whose colour repeats that of another; 0 if there are not so many numbers."""
    most = max((int(c.run.tracks.id.max(initial=0)) for c in columns), default=0)
    return TRACK_COLOURS + 1 if most > TRACK_COLOURS else 0


def _tiles(column: Column) -> list[Picture]:
    """The tiles of a run's contact sheet; none if it is gone."""
    try:
        tiles = read_tiles(column.run.folder / "contact_sheet.png")
    except BadInput:
        return []
    return [Picture(_jpeg_of(tile.picture), tile.words) for tile in tiles]


def _scenes(columns: Sequence[Column]) -> list[Scene]:
    """The worst moments: of single runs in time, of many runs the worst of the worst runs."""
    scenes = []
    singles = [column for column in columns if column.is_single]
    together = are_same_scene(columns)
    count = max(_MOMENTS // max(len(singles), 1), 2)
    found = {column.label: worst_moments(column.outcomes[0], count) for column in singles}
    beside = {c.label: c.outcomes[0] for c in singles}
    frames = common_frames([moment for moments in found.values() for moment in moments])
    shown = {
        label: show_frames(outcome.run, _within(outcome, frames if together else common_frames(found[label])))
        for label, outcome in beside.items()
    }
    for column in singles:
        among = {k: v for k, v in shown.items() if together or k == column.label}
        scenes += [_scene(moment, column.label, column.outcomes[0], among) for moment in found[column.label]]
    for column in columns:
        if not column.is_single:
            scenes += _scenes_of_many(column)
    return scenes


def _within(outcome: Outcome, frames: Sequence[int]) -> list[int]:
    return [frame for frame in frames if frame <= outcome.run.frames]


def _scenes_of_many(column: Column) -> list[Scene]:
    worst = [(outcome, worst_moments(outcome, _MOMENTS)) for outcome in column.outcomes]
    ranked = [
        (max(moments, key=lambda moment: moment.badness), outcome) for outcome, moments in worst if moments
    ]
    ranked.sort(key=lambda pair: -pair[0].badness)
    return [
        _scene(
            moment,
            f"{column.label}, {outcome.run.name}",
            outcome,
            {column.label: show_frames(outcome.run, moment.frames)},
        )
        for moment, outcome in ranked[:_RUNS_SHOWN]
    ]


def _scene(moment: BadMoment, whose: str, outcome: Outcome, shown: dict[str, dict[int, Shown]]) -> Scene:
    shots = []
    for frame in moment.frames:
        time_s = outcome.run.time_s(frame)
        pictures = [
            (
                label,
                Picture(_jpeg(of_run[frame]), f"{moment.title}, thermal image at {time_s:.1f} s, {label}"),
            )
            for label, of_run in shown.items()
            if frame in of_run
        ]
        shots.append(Shot(time_s=time_s, pictures=tuple(pictures)))
    origins = dict.fromkeys(
        of_run[f].origin for of_run in shown.values() for f in moment.frames if f in of_run
    )
    return Scene(moment=moment, whose=whose, shots=tuple(shots), origin="; ".join(origins))


def _charts(columns: Sequence[Column]) -> list[Chart]:
    """Whether people are found, and how far off the boxes are, over distance and visible share."""
    charts = []
    for figure, title, top, unit in (
        (found_share, "People found", 100.0, "%"),
        (offset, "How far the box is off", None, "px"),
    ):
        for over, edges, label, words in (
            (distance, DISTANCES_M, "distance from the camera [m]", "over distance"),
            (visible, VISIBLE, "share of the person that is visible", "over visible share"),
        ):
            curves = [curve(c.label, c.outcomes, over, figure, edges) for c in columns]
            ticks = edges if over is visible else edges[1::2]
            span = (edges[0], edges[-1])
            charts.append(chart(f"{title} {words} [{unit}]", curves, label, span, ticks, top, unit))
    return charts


def _lengths(columns: Sequence[Column]) -> list[tuple[str, list[str]]]:
    """By how long people were wholly hidden: how many kept their identity, in each column."""
    tables = [by_length([o for of_run in c.occlusions for o in of_run]) for c in columns]
    rows = []
    for index, (low, high) in enumerate(pairwise(LENGTHS_S)):
        cells = [f"{t[index].kept} of {t[index].occlusions}" if t[index].occlusions else "-" for t in tables]
        if any(cell != "-" for cell in cells):
            name = f"{low:g} to {high:g} s" if high < LENGTHS_S[-1] else f"over {low:g} s"
            rows.append((name, cells))
    return rows


def _settings(column: Column) -> list[tuple[str, str]]:
    """What is needed to do it again, name and value."""
    about, played = column.run.about, column.run.played
    robot: Any = played.get("robot", {})
    behaviour = robot.get("behaviour", "stand") if isinstance(robot, dict) else "stand"
    is_usable = column.run.scenario is not None
    seeds = [str(outcome.run.about["seed"]) for outcome in column.outcomes]
    rows = [
        ("scenario", ", ".join(dict.fromkeys(str(o.run.about["scenario"]) for o in column.outcomes))),
        ("what happens", " ".join(str(played.get("description", "")).split()) if column.is_single else ""),
        ("seed" if column.is_single else "seeds", ", ".join(dict.fromkeys(seeds))),
        ("tracker", str(about["tracker"])),
        ("robot", str(behaviour) if played else ""),
        ("faults", _faults(played.get("faults", []))),
        ("renderer", str(about["renderer"])),
        ("length", f"{column.run.frames} frames, {about['rate_hz']} a second" if column.is_single else ""),
        ("versions", ", ".join(f"{name} {version}" for name, version in about["versions"].items())),
        ("folder", str(column.run.folder if column.is_single else column.run.folder.parent)),
        (
            "again",
            f"peopleboy run {column.run.folder}/scenario.yaml --tracker {about['tracker']} --out NEW"
            if is_usable
            else "",
        ),
    ]
    return [(name, value) for name, value in rows if value]


def _faults(faults: Any) -> str:
    return ", ".join(f"{f['kind']} from {f['from_s']:g} s" for f in faults if isinstance(f, dict))


def _jpeg(shown: Shown) -> str:
    return _address("jpeg", encode_jpeg(shown.picture, _JPEG_QUALITY))


def _jpeg_of(image: Image.Image) -> str:
    buffer = io.BytesIO()
    image.save(buffer, "JPEG", quality=_TILE_QUALITY, optimize=True)
    return _address("jpeg", buffer.getvalue())


def _address(kind: str, data: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
