"""The page: every table and figure of the sources beside ours, in one file that needs nothing else."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import jinja2

from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.studies.reproduce.experiments.experiment import Experiment, Samples
from peopleboy.scenarios.studies.reproduce.showing.against_source import (
    SIGNIFICANT,
    ClaimStatus,
    Verdict,
    judge,
    mean_and_spread,
)
from peopleboy.scenarios.studies.reproduce.showing.experiment_plots import draw
from peopleboy.scenarios.studies.reproduce.showing.source import Claim, SourceTable, source_tables

HERE = Path(__file__).parent
NOTES = HERE / "notes.yaml"
MAIN = {"literal": ("literal",), "default": ("default", "held out")}

Figures = Mapping[str, tuple[float, float | None]]


@dataclass(frozen=True, slots=True)
class PageRow:
    """One line of a table on the page: a group, whose figures, and the cells as text."""

    group: str
    who: str
    cells: tuple[str, ...]
    is_source: bool
    is_first: bool


@dataclass(frozen=True, slots=True)
class Checked:
    """A claim of the source, and how it went."""

    claim: Claim
    verdicts: tuple[Verdict, ...]


@dataclass(frozen=True, slots=True)
class Section:
    """One table or figure on the page."""

    id: str
    table: SourceTable
    columns: tuple[str, ...]
    rows: tuple[PageRow, ...]
    picture: str | None
    checked: tuple[Checked, ...]
    why: str

    def summary(self, main: str) -> str:
        """How the source's claims fare with a main tracker, in a few words."""
        verdicts = (verdict for item in self.checked for verdict in item.verdicts)
        count = Counter(verdict.outcome for verdict in verdicts if verdict.who in MAIN[main])
        return ", ".join(f"{outcome.value}: {count[outcome]}" for outcome in ClaimStatus if count[outcome])


@dataclass(frozen=True, slots=True, kw_only=True)
class PageHead:
    """What the page says of the run.

    Attributes:
        command: by which it can be repeated.
        is_quick: whether only a little was done.
        amount: what was done, in words.
        facts: further lines: versions, machine, time.
    """

    command: str
    is_quick: bool
    amount: str
    facts: Mapping[str, str]


def write_page(path: Path, results: Sequence[tuple[Experiment, Samples]], about: PageHead) -> None:
    """Write the page."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["points"] = lambda value: "-" if math.isnan(value) else f"{value:+.2f}"
    environment.filters["chance"] = chance
    sections = [section(experiment, samples) for experiment, samples in results]
    notes = _notes()
    text = environment.get_template("page.html.jinja").render(
        sections=sections, about=about, general=notes["general"], significant=SIGNIFICANT
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def section(experiment: Experiment, samples: Samples) -> Section:
    """Lay out one table or figure."""
    table = source_tables()[experiment.id]
    columns = tuple(dict.fromkeys(name for figures in samples.values() for name in figures))
    return Section(
        id=experiment.id,
        table=table,
        columns=columns,
        rows=tuple(rows(samples, table, columns)),
        picture=draw(experiment, samples, table),
        checked=tuple(Checked(claim, tuple(judge(claim, samples))) for claim in table.claims),
        why=_notes()["why"].get(experiment.id, ""),
    )


def rows(samples: Samples, table: SourceTable, columns: Sequence[str]) -> list[PageRow]:
    """Put the source's lines before ours, group by group."""
    lines: dict[str, list[tuple[str, Figures, bool]]] = {}
    for value in table.values:
        lines.setdefault(value.group, []).append((value.who, value.figures, True))
    for line, figures in samples.items():
        ours = {name: mean_and_spread(values) for name, values in figures.items()}
        lines.setdefault(line.group, []).append((line.who, ours, False))
    write = _writer([figures for parts in lines.values() for _, figures, _ in parts])
    return [
        PageRow(group, who, tuple(write(figures.get(name)) for name in columns), is_source, number == 0)
        for group in in_order(lines)
        for number, (who, figures, is_source) in enumerate(lines[group])
    ]


def in_order(groups: Iterable[str]) -> list[str]:
    """Sort groups that are numbers; leave others as they come."""
    listed = list(groups)
    try:
        return sorted(listed, key=lambda group: float(group.removesuffix(" %")))
    except ValueError:
        return listed


def chance(p: float) -> str:
    """Write a p-value."""
    if math.isnan(p):
        return "no test"
    return "p < 0.001" if p < 0.001 else f"p = {p:.3f}"


def _writer(lines: Sequence[Figures]) -> Callable[[tuple[float, float | None] | None], str]:
    """Choose how a table's figures are written: counts, times of less than 1 ms, or two decimals."""
    known = [mean for figures in lines for mean, _ in figures.values() if not math.isnan(mean)]
    are_counts = all(mean == round(mean) for mean in known)
    are_times = any("ms" in figures for figures in lines)

    def write(figure: tuple[float, float | None] | None) -> str:
        if figure is None or math.isnan(figure[0]):
            return "-"
        mean, spread = figure
        if are_counts:
            return f"{mean:.0f}"
        text = f"{mean:#.2g}" if are_times and mean < 1 else f"{mean:.2f}"
        return text if spread is None else f"{text} ± {spread:.2f}"

    return write


def _notes() -> dict[str, dict[str, str]]:
    notes: dict[str, dict[str, str]] = read_yaml(NOTES)
    return notes
