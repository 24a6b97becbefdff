"""Write the page: printed and measured tables and figures of the sources, as one self-contained file."""

import math
import os
import platform
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.report.page_parts import render_page
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.running.engine.store import Store
from peopleboy.studies.reproductions.catalogue import EXPERIMENTS, PAPERS, paper_of
from peopleboy.studies.reproductions.comparison import (
    MUCH,
    ClaimStatus,
    Compared,
    Standing,
    Verdict,
    compare,
    effects_to_source,
    judge,
)
from peopleboy.studies.reproductions.experiment import Claim, Experiment, ExperimentOutcome, Samples
from peopleboy.studies.reproductions.pictures.plots import draw
from peopleboy.studies.reproductions.plan import QUICK_S, Plan, full_plan
from peopleboy.studies.reproductions.statistics import (
    PAPER,
    PART,
    POINTS,
    THESIS,
    ResultDifference,
    mean_and_spread,
)

METRICS: Final = (*THESIS, *PAPER)
HERE: Final = Path(__file__).parent
MAIN: Final = {
    "literal": ("literal", "literal, held out", "as printed", "room_long, random split", "room_long"),
    "default": ("default", "default, held out", "measured"),
}
MAIN_ROWS: Final = ("default", "default, strict")
THREE_DECIMALS: Final = ("m", "|r|", "rate", "FP per image", "recall", "figure", "from", "to")
"""Columns with three decimals, besides those that end in [m]."""
COUNTS: Final = (
    *("images", "TP", "FN", "FP", "people", "others"),
    *("parameters", "pairs", "weak classifiers"),
)
"""Columns without decimals."""
EFFECT: Final = "d to the source (95 %)"

Cells = Mapping[str, tuple[float, float | None]]


@dataclass(frozen=True, slots=True)
class PageRow:
    """One line of a table on the page: group, method, and cells as text."""

    group: str
    method: str
    cells: tuple[str, ...]
    is_source: bool
    is_first: bool


@dataclass(frozen=True, slots=True)
class Checked:
    """A claim of the source, and its results by method."""

    claim: Claim
    verdicts: tuple[Verdict, ...]


@dataclass(frozen=True, slots=True)
class Section:
    """One table or figure on the page."""

    outcome: ExperimentOutcome
    columns: tuple[str, ...]
    rows: tuple[PageRow, ...]
    picture: str | None
    checked: tuple[Checked, ...]
    compared: tuple[Compared, ...]

    @property
    def id(self) -> str:
        """Id of the experiment."""
        return self.outcome.experiment.id

    @property
    def table(self) -> Experiment:
        """The experiment."""
        return self.outcome.experiment

    def summary(self, main: str) -> str:
        """Summarise the results of the source's claims for a main tracker."""
        verdicts = (verdict for item in self.checked for verdict in item.verdicts)
        count = Counter(verdict.outcome for verdict in verdicts if verdict.method in MAIN[main])
        return ", ".join(f"{outcome.value}: {count[outcome]}" for outcome in ClaimStatus if count[outcome])

    def standings(self, main: str) -> str:
        """Summarise how a main tracker's values compare with the printed ones."""
        count = Counter(one.standing for one in self.compared if one.method in MAIN[main])
        return ", ".join(f"{standing.value}: {count[standing]}" for standing in Standing if count[standing])


@dataclass(frozen=True, slots=True, kw_only=True)
class PageHead:
    """Information on the run for the page.

    Attributes:
        command: command that repeats it.
        is_quick: whether it was a quick run.
        amount: extent of the run, as text.
        facts: further lines: versions, machine, time; with the id of a part as key, facts of that part.
    """

    command: str
    is_quick: bool
    amount: str
    facts: Mapping[str, str]

    @property
    def lines(self) -> list[tuple[str, str]]:
        """Return the facts as lines; parts with the same fact share a line."""
        alike: dict[str, list[str]] = {}
        for name in EXPERIMENTS:
            if name in self.facts:
                alike.setdefault(self.facts[name], []).append(name)
        whole = [(name, fact) for name, fact in self.facts.items() if name not in EXPERIMENTS]
        return [*whole, *(("Parts", f"{fact} ({', '.join(parts)})") for fact, parts in alike.items())]


def page_text(sections: Sequence[Section], about: PageHead) -> str:
    """Return the page as HTML."""
    papers = {paper_of(part.id) for part in sections}
    return rendered(
        "page.html.jinja",
        sections=sections,
        about=about,
        general=_notes(),
        sources={name: source for name, source in PAPERS.items() if name in papers},
        below=list(below_source(sections)),
        margins={"points": POINTS, "part": 100 * PART, "much": 100 * MUCH},
        papers=sorted(papers),
        there={part.id for part in sections},
    )


def rendered(template: str, **values: Any) -> str:
    """Fill in a template of this folder."""
    return render_page(template, [HERE], {"points": points, "span": span}, **values)


def section(outcome: ExperimentOutcome) -> Section:
    """Return the section of one table or figure."""
    experiment, samples = outcome.experiment, outcome.samples
    columns = tuple(dict.fromkeys(name for values in samples.values() for name in values))
    effects = tuple(effects_to_source(samples, experiment))
    return Section(
        outcome=outcome,
        columns=(*columns, *((EFFECT,) if any(effects) else ())),
        rows=tuple(_rows(experiment, samples, columns, effects)),
        picture=draw(experiment, samples) if outcome.picture is None else outcome.picture,
        checked=tuple(Checked(claim, tuple(judge(claim, samples))) for claim in experiment.claims),
        compared=tuple(compare(samples, experiment)),
    )


def below_source(sections: Iterable[Section]) -> Iterator[tuple[str, Compared]]:
    """Yield every printed value that the default does not reach, strictly or not, by the part's id.

    Values that appear in several parts are yielded once.
    """
    seen = set()
    for part in sections:
        for one in part.compared:
            what = (one.group, one.column, one.method, one.source)
            if one.method in MAIN_ROWS and one.is_below and what not in seen:
                seen.add(what)
                yield part.id, one


def _rows(
    experiment: Experiment, samples: Samples, columns: Sequence[str], effects: Sequence[str]
) -> Iterator[PageRow]:
    """Return printed and measured lines, group by group; effect sizes, if known, are the last cells."""
    lines: dict[str, list[tuple[str, Cells, bool, str]]] = {}
    for printed in experiment.values:
        lines.setdefault(printed.group, []).append((printed.method, printed.values, True, ""))
    for (line, values), effect in zip(samples.items(), effects, strict=True):
        ours = {name: mean_and_spread(several) for name, several in values.items()}
        lines.setdefault(line.group, []).append((line.method, ours, False, effect))
    write = _writer([cells for parts in lines.values() for _, cells, _, _ in parts])
    for group in in_order(lines):
        for number, (method, cells, is_source, effect) in enumerate(lines[group]):
            texts = [write(name, cells.get(name)) for name in columns]
            yield PageRow(
                group, method, (*texts, *((effect,) if any(effects) else ())), is_source, number == 0
            )


def in_order(groups: Iterable[str]) -> list[str]:
    """Sort numeric groups; keep the order of others."""
    listed = list(groups)
    try:
        return sorted(listed, key=lambda group: float(group.removesuffix(" %")))
    except ValueError:
        return listed


def points(value: float, column: str) -> str:
    """Format a difference: metres to the millimetre, two decimals otherwise."""
    return "-" if math.isnan(value) else f"{value:+.{_digits(column)}f}"


def span(difference: ResultDifference, column: str) -> str:
    """Format a difference with its 95 % interval and effect size, as far as they are known."""
    text = points(difference.by, column)
    if difference.is_sure:
        text += f" ({points(difference.low, column)} to {points(difference.high, column)})"
    return f"{text}, {difference.effect}" if difference.effect else text


def _digits(column: str) -> int:
    if column in COUNTS:
        return 0
    return 3 if column in THREE_DECIMALS or column.endswith("[m]") else 2


def _writer(lines: Sequence[Cells]) -> Callable[[str, tuple[float, float | None] | None], str]:
    """Format a table's values: counts, times below 1 ms, or two or three decimals."""
    known = [mean for cells in lines for mean, _ in cells.values() if not math.isnan(mean)]
    are_counts = all(mean == round(mean) for mean in known)

    def write(column: str, cell: tuple[float, float | None] | None) -> str:
        if cell is None or math.isnan(cell[0]):
            return "-"
        mean, spread = cell
        if are_counts:
            return f"{mean:.0f}"
        digits = _digits(column)
        text = f"{mean:#.2g}" if column == "ms" and mean < 1 else f"{mean:.{digits}f}"
        return text if spread is None else f"{text} ± {spread:.{digits}f}"

    return write


def head_of(
    plan: Plan, outcomes: Sequence[ExperimentOutcome], store: Store, *, command: str, missing: Sequence[str]
) -> PageHead:
    """Describe a run: its extent, versions, machine and time.

    Args:
        plan: extent of the run.
        outcomes: finished experiments.
        store: store of all results.
        command: command of the user.
        missing: ids of unfinished experiments.
    """
    papers = {paper_of(one.experiment.id) for one in outcomes}
    scored = [one for one in outcomes if any(set(METRICS) & set(values) for values in one.samples.values())]
    repeats = {one.repeats for one in scored if one.repeats is not None} or {plan.repeats}
    spent = sum(store.spent_s(key) for key in store)
    facts = {
        "Versions": ", ".join(f"{name} {number}" for name, number in versions().items()),
        "Python": platform.python_version(),
        "Seeds": _seeds(plan, papers, max(repeats)),
        "Machine": f"{os.cpu_count()} cores, {platform.machine()}, {platform.system()}",
        "Time": f"{spent / 3600:.2f} core-hours for all results, including earlier calls",
        "Results": f"{len(store)} units of work in {store.path.name}",
    }
    if missing:
        facts["Not finished"] = ", ".join(missing)
    return PageHead(
        command=command, is_quick=plan.is_quick, amount=_amount(plan, papers, repeats), facts=facts
    )


def _seeds(plan: Plan, papers: Set[str], repeats: int) -> str:
    streams = f"random streams of the trackers 0 to {repeats - 1}; data sets as in their files"
    if papers <= {"thesis", "2005"}:
        return streams
    return (
        f"{streams}; webcams 0 to {plan.repeats - 1}; people before a panoramic camera 0 to "
        f"{plan.walks - 1}; drives with a depth camera 0 to {plan.drives - 1}"
    )


def _amount(plan: Plan, papers: Set[str], repeats: Set[int]) -> str:
    """Describe the extent of a run."""
    if plan.is_quick:
        # Share of the data sets in a quick run.
        every = full_plan(plan.cache)
        seen, there = (sum(run.scenario.duration_s for run in one.runs(one.suites)) for one in (plan, every))
        kind, share = "quick", f"{seen:.0f} of {there:.0f} s"
    else:
        kind, share = next((one for one in ("panoramic", "situation") if papers == {one}), "tracking"), ""
    least, most = min(repeats), max(repeats)
    words: str = _notes()["amount"][kind]
    return words.format(
        plan=plan,
        quick_s=QUICK_S,
        share=share,
        **{name: len(getattr(plan, name)) for name in ("sets", "scenes", "presets")},
        turns=2 * plan.drives,
        repeats=f"{most} repeats" if least == most else f"{least} to {most} repeats (stated with each part)",
        runs=", ".join(
            f"{len(runs)} run{'s' if len(runs) != 1 else ''} of {name}" for name, runs in plan.suites.items()
        ),
    )


def _notes() -> dict[str, Any]:
    notes: dict[str, Any] = read_yaml(HERE / "page_notes.yaml")
    return notes
