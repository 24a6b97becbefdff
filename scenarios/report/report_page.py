"""Build the report page of one run, or of several side by side, as one self-contained file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markupsafe import Markup

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.palette import TRACK_COLOURS
from peopleboy.scenarios.report import page_tables
from peopleboy.scenarios.report.charts.error_curves import draw_error_curves
from peopleboy.scenarios.report.charts.paths import draw_paths
from peopleboy.scenarios.report.charts.timelines import PersonTimeline, draw_things, swatch, timelines
from peopleboy.scenarios.report.columns import Column, lacking, read_columns
from peopleboy.scenarios.report.findings.run_findings import RunFindings
from peopleboy.scenarios.report.findings.sentences import listed
from peopleboy.scenarios.report.page_parts import check_place, render_page, write_page
from peopleboy.scenarios.report.page_tables import PageTable
from peopleboy.scenarios.report.pictures import (
    Origin,
    PagePicture,
    PicturedMoment,
    attention_strip,
    contact_sheet,
    pictured_moments,
)
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import describe_images
from peopleboy.scenarios.scores.evaluate_runs import BoxReference
from peopleboy.tracker.frame import THERMAL

HERE = Path(__file__).parent
_NAMED = 4  # scenarios in a title
_DRIVES = {
    "goal": "Driving to the goal",
    "following": "Person following",
    "corridor": "Corridor following",
    "comfort": "Comfort of people near the robot",
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunSection:
    """Contents of a page for a single run."""

    label: str
    found: RunFindings
    losses: PageTable
    occlusions: PageTable
    plan: Markup | None  # None if the place cannot be rebuilt
    attention: Sequence[PagePicture]
    things: Markup
    moves: PageTable
    modes: PageTable
    tiles: Sequence[PagePicture]  # of its contact sheet


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReportPage:
    """Everything that the template of a page shows.

    Attributes:
        columns: the columns of the page.
        singles: sections of columns with a single run.
        crowds: columns of many runs, each with the table of its runs, and whether the table is cut.
        lacking: missing contents and the reasons, one line each.
        moments: the worst moments, with pictures.
        timelines: timelines of each run, or of runs of one scene together, by title.
        first_repeated: number of the first track whose colour repeats that of another; 0 for none.
        lengths: numbers of identities kept, by duration of the occlusion.
        drives: driving metrics, by title.
        curves: charts of errors, by title.
        settings: names and values needed to repeat the run, by label of the column.
    """

    title: str
    columns: Sequence[Column]
    singles: Sequence[RunSection]
    crowds: Sequence[tuple[Column, PageTable, bool]]
    lacking: Sequence[str]
    moments: Sequence[PicturedMoment]
    timelines: Sequence[tuple[str, Sequence[PersonTimeline]]]
    first_repeated: int
    lengths: PageTable
    figures: PageTable
    drives: Mapping[str, PageTable]
    curves: Sequence[tuple[str, Markup]]
    settings: Sequence[tuple[str, Sequence[tuple[str, str]]]]
    all_figures: PageTable

    @property
    def description(self) -> str:
        """Description of the scenario, if the page is about one run."""
        return str(_said(self.columns[0].found.run).get("description", "")) if self.is_of_one_run else ""

    @property
    def is_of_one_run(self) -> bool:
        """Whether there is one run only."""
        return len(self.columns) == len(self.singles) == 1

    @property
    def is_thermal(self) -> bool:
        """Whether all pictures are thermal."""
        return all(found.camera == THERMAL for column in self.columns for found in column.runs)

    @property
    def has_moves(self) -> bool:
        """Whether any object was moved."""
        return any(section.moves.rows for section in self.singles)

    @property
    def has_modes(self) -> bool:
        """Whether a robot had more than one mode."""
        return any(len(section.modes.rows) > 1 for section in self.singles)


def write_report(paths: Sequence[Path], out: Path) -> list[str]:
    """Write the page about the runs in these folders.

    Args:
        paths: as for `read_columns`.
        out: file of the page; nothing is written after an error.

    Returns:
        Missing contents of the page and the reasons, one line each.

    Raises:
        BadInput: there is no complete run, or the page cannot be written to this file.
    """
    check_place(out)
    columns = read_columns(paths)
    moments = pictured_moments(columns)
    lines = [*lacking(columns), *_notes(columns), *_unknown(columns), *_without_images(moments)]
    page = make_page(columns, moments, lines)
    write_page(render_page("page.html.jinja", [HERE], page=page, swatch=swatch), out)
    return lines


def make_page(
    columns: Sequence[Column], moments: Sequence[PicturedMoment], lines: Sequence[str]
) -> ReportPage:
    """Build the contents of the page; `lines` describe what is missing."""
    singles = [column for column in columns if column.is_single]
    crowds = [column for column in columns if not column.is_single]
    return ReportPage(
        title=_title(columns),
        columns=columns,
        singles=[_section(column) for column in singles],
        crowds=[(c, page_tables.runs_of(c), len(c.runs) > page_tables.LONGEST) for c in crowds],
        lacking=lines,
        moments=moments,
        timelines=timelines(columns),
        first_repeated=_first_repeated(singles),
        lengths=page_tables.identities_kept(columns),
        figures=page_tables.plain_figures(columns),
        drives={title: page_tables.drive_figures(columns, name) for name, title in _DRIVES.items()},
        curves=draw_error_curves(columns),
        settings=[(column.label, _settings(column)) for column in columns],
        all_figures=page_tables.all_figures(columns),
    )


def _section(column: Column) -> RunSection:
    found = column.found
    return RunSection(
        label=column.label,
        found=found,
        losses=page_tables.losses(found),
        occlusions=page_tables.occlusions(column),
        plan=draw_paths(found, column.label),
        attention=attention_strip(found),
        things=draw_things(found, column.label),
        moves=page_tables.moves(found),
        modes=page_tables.modes(found),
        tiles=contact_sheet(found.run),
    )


def _notes(columns: Sequence[Column]) -> list[str]:
    """Return the caveats of the metrics, one line per tracker."""
    return [f"{column.found.run.about.tracker}: {note}" for column in columns for note in column.notes]


def _unknown(columns: Sequence[Column]) -> list[str]:
    """Return one line per tracker with the unknown properties of its imported tracks."""
    adopted = {f.run.about.tracker: f.run.about.adopted for column in columns for f in column.runs}
    return [
        f"the tracks of {name} are imported: their {listed(imported.unknown)} are unknown"
        for name, imported in adopted.items()
        if imported is not None
    ]


def _without_images(moments: Sequence[PicturedMoment]) -> list[str]:
    """Return a notice if images should be rendered again, but PyBullet is missing."""
    line = "PyBullet is not installed: moments of runs without --frames show boxes only"
    return [line] * any(Origin.NO_PHYSICS in moment.origins for moment in moments)


def _title(columns: Sequence[Column]) -> str:
    """Return the title: scenario and seed of single runs, else scenarios and number of runs."""
    runs = [found.run for column in columns for found in column.runs]
    if len(runs) == len(columns):
        return listed(list(dict.fromkeys(run.title for run in runs)))
    names = list(dict.fromkeys(run.about.scenario for run in runs))
    return f"{listed(names) if len(names) <= _NAMED else f'{len(names)} scenarios'}: {len(runs)} runs"


def _first_repeated(singles: Sequence[Column]) -> int:
    """Return the first track number whose colour repeats that of another; 0 if there is none."""
    most = max((int(c.found.boxes[1].id.max(initial=0)) for c in singles), default=0)
    return TRACK_COLOURS + 1 if most > TRACK_COLOURS else 0


def _settings(column: Column) -> list[tuple[str, str]]:
    """Return the names and values needed to repeat the run."""
    found = column.found
    run, runs = found.run, [one.run for one in column.runs]
    played, about, adopted = _said(run), run.about, run.about.adopted
    robot: Any = played.get("robot", {})
    behaviour = robot.get("behaviour", "stand") if isinstance(robot, dict) else "stand"
    seeds = ", ".join(dict.fromkeys(str(one.about.seed) for one in runs))
    rows = [
        ("scenario", ", ".join(dict.fromkeys(one.about.scenario for one in runs))),
        ("description", " ".join(str(played.get("description", "")).split()) if column.is_single else ""),
        ("seed" if column.is_single else "seeds", seeds),
        ("tracker", about.tracker),
        ("tracks", "" if adopted is None else f"{adopted.tracks}, imported"),
        ("boxes", "" if found.yardstick == BoxReference() else f"scored against {found.yardstick}"),
        ("robot", about.behaviour or (str(behaviour) if played else "")),
        ("robot driven by", "" if adopted is None else adopted.driven_by),
        ("images", _images(run)),
        ("faults", _faults(played.get("faults", []))),
        ("renderer", about.renderer),
        ("length", f"{run.frames} frames, {run.rate_hz} per second" if column.is_single else ""),
        ("versions", ", ".join(f"{name} {version}" for name, version in about.versions.items())),
        ("folder", str(run.folder if column.is_single else run.folder.parent)),
    ]
    if not lacking([column]) and adopted is None:
        steered = "" if about.behaviour is None else f" --behaviour {about.behaviour}"
        steered += "" if about.boxes == "torso" else f" --boxes {about.boxes}"
        command = f"peopleboy run {run.folder}/scenario.yaml --tracker {about.tracker}{steered} --out NEW"
        rows.append(("repeat", command))
    return [(name, value) for name, value in rows if value]


def _images(run: FinishedRun) -> str:
    """Describe the cameras' images; empty if the scenario is unreadable."""
    try:
        return describe_images([run.robot.cameras])
    except BadInput:
        return ""


def _said(run: FinishedRun) -> Mapping[str, Any]:
    """Return the content of scenario.yaml; empty if it is unreadable."""
    try:
        return run.played
    except BadInput:
        return {}


def _faults(faults: Any) -> str:
    return ", ".join(f"{f['kind']} from {f['from_s']:g} s" for f in faults if isinstance(f, dict))
