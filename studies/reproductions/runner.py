"""Reproduce the tables and figures of the sources, print them, and write the page."""

import json
import math
import shlex
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import Field
from rich.console import Console
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.running.engine.store import Store
from peopleboy.scenarios.running.engine.task import Failure, TasksFailed, Workers
from peopleboy.scenarios.running.many_runs import films_of
from peopleboy.scenarios.scores.suite_table import THESIS, Content, add_up, count
from peopleboy.studies.reproductions.catalogue import choose
from peopleboy.studies.reproductions.comparison import Compared
from peopleboy.studies.reproductions.experiment import Experiment, ExperimentOutcome
from peopleboy.studies.reproductions.plan import REPEATS, Plan, full_plan, quick_plan
from peopleboy.studies.reproductions.source_page import Checked, Section, head_of, page_text, section, span
from peopleboy.studies.reproductions.statistics import mean_and_spread
from peopleboy.studies.reproductions.units import Unfinished, Unit, open_store, run_units

PAGE: Final = "index.html"
RESULTS: Final = "units.jsonl"
MEANS: Final = "figures.json"
_FILE_WIDTH: Final = 160  # width of printed tables in a file, in characters
_RATE_HZ: Final = 15.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Means:
    """Resources of a reproduction.

    Attributes:
        out: folder of the page and the results.
        workers: workers that execute the units.
        command: command of the user.
    """

    out: Path
    workers: Workers = field(default_factory=Workers)
    command: str = "peopleboy reproduce"


def reproduce(
    experiments: Sequence[Experiment], plan: Plan, means: Means, *, so_far: bool = False
) -> tuple[Path, list[Section]]:
    """Run missing units, and write the page, and the means of all values to the same folder.

    A killed run resumes with the same folder and reuses its results. Experiments that cannot be finished,
    since units failed, are omitted from the page.

    Args:
        experiments: the experiments to reproduce.
        plan: extent of the run.
        means: resources of the run.
        so_far: run nothing, and show the results in the folder, each part with its number of repeats.

    Returns:
        The page, and its sections.

    Raises:
        BadInput: the folder or the cluster cannot be used, or no experiment is finished.
        TasksFailed: some units failed, after all others were completed.
    """
    if so_far and not (means.out / RESULTS).is_file():
        raise BadInput(f"{means.out / RESULTS}: no table or figure is finished there")
    store = open_store(means.out / RESULTS)
    known, failures = ({}, []) if so_far else work_off(experiments, plan, store, means.workers)
    outcomes, missing = finished(experiments, plan, store, known)
    (means.out / MEANS).write_text(json.dumps(_mean_values(outcomes), indent=1) + "\n", encoding="utf-8")
    sections, page = [section(one) for one in outcomes], means.out / PAGE
    about = head_of(plan, outcomes, store, command=means.command, missing=missing)
    page.write_text(page_text(sections, about), encoding="utf-8")
    if failures:
        raise TasksFailed("reproduce", failures, len(store) + len(failures))
    return page, sections


def work_off(
    experiments: Sequence[Experiment], plan: Plan, store: Store, workers: Workers
) -> tuple[dict[str, ExperimentOutcome], list[Failure]]:
    """Run missing units, stage by stage, until all experiments are finished or blocked by a failed unit.

    A unit that several experiments need runs once; a failed unit blocks only experiments that need it.

    Raises:
        BadInput: the cluster cannot be used.
    """
    outcomes: dict[str, ExperimentOutcome] = {}
    failures: dict[str, Failure] = {}
    while True:
        wanted: dict[str, Unit] = {}
        for one in experiments:
            if one.id not in outcomes:
                try:
                    outcomes[one.id] = ExperimentOutcome.of(one, plan, store)
                except Unfinished as unfinished:
                    wanted |= {unit.key: unit for unit in unfinished.units if unit.key not in failures}
        if not wanted:
            return outcomes, list(failures.values())
        try:
            run_units(list(wanted.values()), store, workers)
        except TasksFailed as failed:
            failures |= {one.name: one for one in failed.failures}


def finished(
    experiments: Sequence[Experiment],
    plan: Plan,
    store: Store,
    known: Mapping[str, ExperimentOutcome] | None = None,
) -> tuple[list[ExperimentOutcome], list[str]]:
    """Return finished experiments, each with its number of repeats, and the ids of unfinished ones.

    Raises:
        BadInput: no experiment is finished.
    """
    found = {
        one.id: (known or {}).get(one.id) or ExperimentOutcome.so_far(one, plan, store) for one in experiments
    }
    outcomes = [one for one in found.values() if one is not None]
    if not outcomes:
        raise BadInput(f"{store.path}: no table or figure is finished there")
    return outcomes, [number for number, one in found.items() if one is None]


def _mean_values(outcomes: Sequence[ExperimentOutcome]) -> dict[str, Any]:
    """Return the mean of every value by experiment, group, method, and column; None for NaN."""
    tables: dict[str, Any] = {}
    for outcome in outcomes:
        table = tables.setdefault(outcome.experiment.id, {})
        for line, values in outcome.samples.items():
            row = {name: mean_and_spread(several)[0] for name, several in values.items()}
            plain = {name: None if math.isnan(mean) else mean for name, mean in row.items()}
            table.setdefault(line.group, {})[line.method] = plain
    return tables


@dataclass(frozen=True, slots=True, kw_only=True)
class ReproduceOptions:
    """Options of a reproduction.

    Attributes:
        films: folder of rendered frames.
    """

    paper: Annotated[
        str | None,
        Field(
            description="Reproduce only one source: thesis (2007), 2005 (the paper that evaluates its "
            "tracker), panoramic (2003), or situation (the thesis on depth and colour)."
        ),
    ] = None
    quick: Annotated[
        bool,
        Field(description="Reproduce a small part of every result, in minutes; the page lists which parts."),
    ] = False
    seeds: Annotated[
        int | None,
        Field(
            ge=1,
            description="Number of seeds or random streams per result. A later call with more seeds "
            "reuses existing results.  [default: 10, as in the sources]",
        ),
    ] = None
    out: Annotated[
        Path | None,
        Field(
            description="Folder for the page and the results.  [default: runs/reproduce, or "
            "runs/reproduce-quick]"
        ),
    ] = None
    label_noise_px: Annotated[
        float,
        Field(
            ge=0.0,
            le=50.0,
            description="Standard deviation [px] of noise at the edges of ground-truth boxes, as if drawn by "
            "hand. It applies to the thesis (2007) and the paper of 2005.",
        ),
    ] = 0.0
    films: Path
    so_far: Annotated[
        bool,
        Field(description="Only write the page, from results that are already in the folder."),
    ] = False

    def __post_init__(self) -> None:
        """Refuse a quick run with a number of seeds.

        Raises:
            BadInput: both are given.
        """
        if self.quick and self.seeds is not None:
            raise BadInput("reproduce: --quick has its own number of seeds; give either --quick or --seeds")

    @property
    def folder(self) -> Path:
        """Folder of the page and the results."""
        return self.out or Path("runs") / ("reproduce-quick" if self.quick else "reproduce")


def reproduce_named(
    names: Sequence[str], options: ReproduceOptions, workers: Workers
) -> tuple[Path, Sequence[Section]]:
    """Reproduce the results of these names, or all, and return the page and its sections.

    Args:
        names: ids or numbers; all if omitted.
        options: options of the reproduction.
        workers: workers that execute the units.

    Raises:
        BadInput: an unknown name, or a folder or cluster that cannot be used.
        TasksFailed: some units failed, after all else was done.
    """
    paper, repeats = options.paper, None if options.quick else options.seeds or REPEATS
    experiments = choose(names, paper)
    # Workers may have another working directory.
    cache = options.films.resolve()
    plan = quick_plan(cache) if repeats is None else full_plan(cache, repeats)
    plan = replace(plan, label_noise_px=options.label_noise_px)
    chosen = [] if paper is None else ["--paper", paper]
    fewer = [] if repeats == REPEATS else ["--quick"] if repeats is None else ["--seeds", str(repeats)]
    noise = ["--label-noise-px", f"{options.label_noise_px:g}"] if options.label_noise_px else []
    command = shlex.join(["peopleboy", "reproduce", *chosen, *fewer, *noise, *names])
    means = Means(out=options.folder, workers=workers, command=command)
    return reproduce(experiments, plan, means, so_far=options.so_far)


def print_experiments(experiments: Sequence[Experiment]) -> None:
    """Print ids, sources and titles."""
    rows = [(one.id, one.source, one.title) for one in experiments]
    Console().print(rich_table(("id", "source", "title"), rows, pad_edge=True))


def rich_table(
    head: Sequence[str], rows: Iterable[Sequence[str]], *, left: int | None = None, **style: Any
) -> Table:
    """Return a table without lines.

    Args:
        head: names of the columns.
        rows: their cells.
        left: number of leading columns with text, before those with numbers; None for all.
        style: of the table.
    """
    table = Table(box=None, header_style="bold", **({"pad_edge": False} | style))
    for number, name in enumerate(head):
        table.add_column(Text(name), justify="left" if left is None or number < left else "right")
    for row in rows:
        table.add_row(*map(Text, row))
    return table


def print_sections(sections: Iterable[Section]) -> None:
    """Print every section: its table, and the results of the source's claims."""
    console = Console(width=None if sys.stdout.isatty() else _FILE_WIDTH, highlight=False)
    for part in sections:
        console.print(
            f"[bold]{escape(part.id)}[/bold]: {escape(part.table.title)} ({escape(part.table.source)})"
        )
        if part.rows:
            rows = [(row.group if row.is_first else "", row.method, *row.cells) for row in part.rows]
            table = rich_table(("", "", *part.columns), rows, left=2)
            for line, row in zip(table.rows, part.rows, strict=True):
                line.style = "dim" if row.is_source else ""
            console.print(table)
        if part.compared:
            head = ("", "", "", "measured less source (95 %), effect size", "")
            console.print(rich_table(head, map(_compared, part.compared)))
        if part.picture is not None:
            console.print("  the page has a picture")
        for item in part.checked:
            _print_claim(console, item)
        if part.outcome.left_out:
            console.print(f"  omitted from this run: {escape(', '.join(part.outcome.left_out))}")
        console.print()


def _compared(one: Compared) -> tuple[str, ...]:
    return one.group, one.column, one.method, span(one.difference, one.column), one.standing.value


def _print_claim(console: Console, item: Checked) -> None:
    metric = item.claim.metric
    console.print(f"  {escape(item.claim.says)}")
    for one in item.verdicts:
        times = "" if one.times is None else f"{one.times:.2f} times; "
        text = f"{one.outcome.value}; {times}{metric} {span(one.difference, metric)}"
        console.print(f"    {escape(one.method)}: {escape(text)}")
        for test in one.tests:
            console.print(f"      {escape(test)}")


def count_suite(name: str, films: Path) -> Content:
    """Count the content of a suite; missing frames are rendered to the folder."""
    return add_up(count(shot.people(), shot.frames, _RATE_HZ) for shot in films_of(name, films))


def contents_of(names: Sequence[str], films: Path) -> dict[str, Content]:
    """Count the contents of data sets, by name."""
    return {name: count_suite(name, films) for name in names}


def contents_to_json(ours: Mapping[str, Content]) -> dict[str, Any]:
    """Return the contents of rendered data sets, each with the published contents."""
    return {name: {"rendered": asdict(one), "published": asdict(THESIS[name])} for name, one in ours.items()}


def print_contents(ours: Mapping[str, Content]) -> None:
    """Print the contents of data sets, with those of the thesis in brackets."""
    rows = [
        (
            one.name.replace("_", " "),
            *(
                f"{getattr(content, one.name)} ({getattr(THESIS[name], one.name)})"
                for name, content in ours.items()
            ),
        )
        for one in fields(Content)
    ]
    title = {"title": "thesis, table 3.1: rendered (published)", "title_justify": "left"}
    table = rich_table(("", *ours), rows, left=1, **title)
    (Console() if sys.stdout.isatty() else Console(width=120)).print(table)
