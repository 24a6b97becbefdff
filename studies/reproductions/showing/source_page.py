"""The page: every table and figure of the sources beside ours, in one file that needs nothing else."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import jinja2

from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.studies.reproductions.experiments.catalogue import EXPERIMENTS, paper_of
from peopleboy.studies.reproductions.experiments.experiment import Effort, Outcome, Samples
from peopleboy.studies.reproductions.showing.against_source import (
    MUCH,
    ClaimStatus,
    Verdict,
    effect_to_source,
    judge,
    mean_and_spread,
)
from peopleboy.studies.reproductions.showing.beside_source import Compared, Standing, compare
from peopleboy.studies.reproductions.showing.experiment_plots import draw
from peopleboy.studies.reproductions.showing.intervals import PART, POINTS, Gap
from peopleboy.studies.reproductions.showing.source import Claim, SourceTable, source_tables
from peopleboy.studies.reproductions.showing.source_contents import source_contents
from peopleboy.studies.training.distance_learning.image_errors import ImageErrors

HERE = Path(__file__).parent
NOTES = HERE / "notes.yaml"
MAIN = {
    "literal": ("literal", "literal, held out", "as printed", "room_long, random split", "room_long"),
    "default": ("default", "default, held out", "measured"),
}
MAIN_ROWS = ("default", "default, strict")
FINE = (
    "m",
    "|r|",
    "rate",
    "FP per image",
    "recall",
    "figure",
    "from",
    "to",
)  # columns that need three decimals
COUNTS = (
    "images",
    "TP",
    "FN",
    "FP",
    "people",
    "others",
    "parameters",
    "pairs",
    "weak classifiers",
)  # columns that need none
EFFECT = "d to the source (95 %)"

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
    compared: tuple[Compared, ...]
    why: str
    left_out: tuple[str, ...] = ()
    effort: Effort | None = None
    repeats: int | None = None
    films: int | None = None

    def summary(self, main: str) -> str:
        """How the source's claims fare with a main tracker, in a few words."""
        verdicts = (verdict for item in self.checked for verdict in item.verdicts)
        count = Counter(verdict.outcome for verdict in verdicts if verdict.who in MAIN[main])
        return ", ".join(f"{outcome.value}: {count[outcome]}" for outcome in ClaimStatus if count[outcome])

    def standings(self, main: str) -> str:
        """How a main tracker's figures stand beside the printed ones, in a few words."""
        count = Counter(one.standing for one in self.compared if one.who in MAIN[main])
        return ", ".join(f"{standing.value}: {count[standing]}" for standing in Standing if count[standing])


@dataclass(frozen=True, slots=True, kw_only=True)
class PageHead:
    """What the page says of the run.

    Attributes:
        command: by which it can be repeated.
        is_quick: whether only a little was done.
        amount: what was done, in words.
        facts: further lines: versions, machine, time; by a part's id, what holds for it alone.
    """

    command: str
    is_quick: bool
    amount: str
    facts: Mapping[str, str]

    @property
    def lines(self) -> list[tuple[str, str]]:
        """Give the facts as they are listed: parts of which the same is said share a line, as they come."""
        alike: dict[str, list[str]] = {}
        for name in EXPERIMENTS:
            if name in self.facts:
                alike.setdefault(self.facts[name], []).append(name)
        whole = [(name, fact) for name, fact in self.facts.items() if name not in EXPERIMENTS]
        return [*whole, *(("Parts", f"{fact} ({', '.join(parts)})") for fact, parts in alike.items())]


def write_page(path: Path, sections: Sequence[Section], about: PageHead) -> None:
    """Write the page."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page_text(sections, about), encoding="utf-8")


def page_text(sections: Sequence[Section], about: PageHead) -> str:
    """Give the page as HTML."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["points"] = points
    environment.filters["span"] = span
    notes = _notes()
    papers = {paper_of(part.id) for part in sections}
    return environment.get_template("page.html.jinja").render(
        sections=sections,
        about=about,
        general=notes["general"],
        below=list(below_source(sections)),
        margins={"points": POINTS, "part": 100 * PART, "much": 100 * MUCH},
        papers=sorted(papers),
        contents={name: items for name, items in source_contents().items() if name in papers},
        there={part.id for part in sections},
    )


def section(outcome: Outcome) -> Section:
    """Lay out one table or figure."""
    experiment, samples = outcome.experiment, outcome.samples
    table = source_tables()[experiment.id]
    columns = tuple(dict.fromkeys(name for figures in samples.values() for name in figures))
    drawn = draw(experiment, samples, table) if outcome.picture is None else outcome.picture
    effects = tuple(effects_to_source(samples, table))
    return Section(
        id=experiment.id,
        table=table,
        columns=(*columns, *((EFFECT,) if any(effects) else ())),
        rows=tuple(rows(samples, table, columns, effects)),
        picture=drawn,
        checked=tuple(Checked(claim, tuple(judge(claim, samples))) for claim in table.claims),
        compared=tuple(compare(samples, table)),
        why=_notes()["why"].get(experiment.id, ""),
        left_out=outcome.left_out,
        effort=outcome.effort,
        repeats=outcome.repeats,
        films=outcome.films,
    )


def below_source(sections: Iterable[Section]) -> Iterator[tuple[str, Compared]]:
    """Give every printed figure that the default does not reach, strictly or not, by the part's id.

    Figures that several parts have are given once.
    """
    seen = set()
    for part in sections:
        for one in part.compared:
            what = (one.group, one.column, one.who, one.source)
            if one.who in MAIN_ROWS and one.is_below and what not in seen:
                seen.add(what)
                yield part.id, one


def effects_to_source(samples: Samples, table: SourceTable) -> Iterator[str]:
    """Say for each of our lines how far it is from the source's of its group; empty where that is unknown."""
    theirs = {value.group: value.figures for value in table.values}
    for line, figures in samples.items():
        of_group = theirs.get(line.group, {})
        yield "".join(
            effect_to_source(values, of_group[name])
            for name, values in figures.items()
            if isinstance(values, ImageErrors) and name in of_group
        )


def rows(
    samples: Samples, table: SourceTable, columns: Sequence[str], effects: Sequence[str] = ()
) -> list[PageRow]:
    """Put the source's lines before ours, group by group; effects, if any is known, are the last cells."""
    lines: dict[str, list[tuple[str, Figures, bool, str]]] = {}
    for value in table.values:
        lines.setdefault(value.group, []).append((value.who, value.figures, True, ""))
    for (line, figures), effect in zip(samples.items(), effects or [""] * len(samples), strict=True):
        ours = {name: mean_and_spread(values) for name, values in figures.items()}
        lines.setdefault(line.group, []).append((line.who, ours, False, effect))
    write = _writer([figures for parts in lines.values() for _, figures, _, _ in parts])
    return [
        PageRow(
            group,
            who,
            (*(write(name, figures.get(name)) for name in columns), *((effect,) if any(effects) else ())),
            is_source,
            number == 0,
        )
        for group in in_order(lines)
        for number, (who, figures, is_source, effect) in enumerate(lines[group])
    ]


def in_order(groups: Iterable[str]) -> list[str]:
    """Sort groups that are numbers; leave others as they come."""
    listed = list(groups)
    try:
        return sorted(listed, key=lambda group: float(group.removesuffix(" %")))
    except ValueError:
        return listed


def points(value: float, column: str) -> str:
    """Write a difference: millimetres of metres, two decimals of all else."""
    return "-" if math.isnan(value) else f"{value:+.{_digits(column)}f}"


def span(difference: Gap, column: str) -> str:
    """Write a difference with its 95 % interval and effect size, as far as they are known."""
    parts = [points(difference.by, column)]
    if difference.is_sure:
        parts[0] += f" ({points(difference.low, column)} to {points(difference.high, column)})"
    return ", ".join([*parts, *([difference.effect] if difference.effect else [])])


def _digits(column: str) -> int:
    if column in COUNTS:
        return 0
    return 3 if column in FINE or column.endswith("[m]") else 2


def _writer(lines: Sequence[Figures]) -> Callable[[str, tuple[float, float | None] | None], str]:
    """Choose how a table's figures are written: counts, times of less than 1 ms, or two or three decimals."""
    known = [mean for figures in lines for mean, _ in figures.values() if not math.isnan(mean)]
    are_counts = all(mean == round(mean) for mean in known)

    def write(column: str, figure: tuple[float, float | None] | None) -> str:
        if figure is None or math.isnan(figure[0]):
            return "-"
        mean, spread = figure
        if are_counts:
            return f"{mean:.0f}"
        digits = _digits(column)
        text = f"{mean:#.2g}" if column == "ms" and mean < 1 else f"{mean:.{digits}f}"
        return text if spread is None else f"{text} ± {spread:.{digits}f}"

    return write


def _notes() -> dict[str, dict[str, str]]:
    notes: dict[str, dict[str, str]] = read_yaml(NOTES)
    return notes
