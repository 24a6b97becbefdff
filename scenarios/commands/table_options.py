"""Options for tables and plots of metrics, which `evaluate` and `sweep` share."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import PATH, Output, print_note

if TYPE_CHECKING:
    from peopleboy.scenarios.scores.by_tracker import Groups
    from peopleboy.scenarios.scores.evaluate_runs import ScoreOptions
    from peopleboy.scenarios.scores.people_ranges import PeopleRange
    from peopleboy.scenarios.scores.tables.score_table import ScoreTable
    from peopleboy.tracker.evaluation.table import Figure

Score = Callable[["PeopleRange | None"], "Groups"]
"""Function that scores runs, for people in a range or for all, and groups them by tracker."""

_FORMS: Final = {"csv": "CSV, one line per metric", "latex": "a LaTeX table", "markdown": "a Markdown table"}
_PER: Final = ("scenario", "sequence", "run", "visible-fraction", "occlusion-time")


@dataclass(frozen=True, slots=True)
class TableOptions:
    """What the user asked for.

    Attributes:
        form: `csv`, `latex`, `markdown`, or None.
        per: name of a `Per`, or None.
        figures: the metrics; empty for the usual ones.
        plots: folder for plots; None for none.
    """

    form: str | None
    per: str | None
    figures: "Sequence[Figure]"
    plots: Path | None

    def show(
        self,
        output: Output,
        score: Score,
        show: Callable[["Groups"], None],
        more: Callable[["Groups"], Mapping[str, object]],
        plots: Callable[[Path, "Groups"], Sequence[Path]],
    ) -> None:
        """Score runs, and print their metrics in the requested form.

        Args:
            output: how the command prints its results.
            score: scores the runs.
            show: prints what the table does not contain, such as comfort, after the metrics.
            more: returns the same for JSON.
            plots: draws the plots of the runs into a folder.

        Raises:
            BadInput: as `score`.
        """
        from peopleboy.scenarios.scores.by_tracker import figures_of_all
        from peopleboy.scenarios.scores.tables.score_table import (
            ALL,
            PAPER_FIGURES,
            Per,
            make_table,
            score_parts,
        )
        from peopleboy.scenarios.scores.tables.show_scores import print_notes, print_runs, print_table
        from peopleboy.scenarios.scores.tables.write_table import WRITERS
        from peopleboy.tracker.evaluation.table import FIGURES

        per = None if self.per is None else Per(self.per)
        parts = score_parts(score, per)
        groups = parts[ALL]
        drawn = [] if self.plots is None else plots(self.plots, groups)

        def table() -> "ScoreTable":
            usual = FIGURES if self.form == "csv" else PAPER_FIGURES
            return make_table(parts, self.figures or usual, per)

        if self.form:
            print_notes(groups, print_note)
            click.echo(WRITERS[self.form](table()), nl=False)
            return

        def show_text() -> None:
            if per is None:
                print_runs(groups, note=print_note, figures=self.figures or FIGURES)
            else:
                print_notes(groups, print_note)
                print_table(table())
            show(groups)
            for path in drawn:
                click.echo(path)

        def to_json() -> dict[str, Any]:
            asked = self.figures or FIGURES
            data = {**figures_of_all(groups, asked), **more(groups)}
            if per is not None:
                split = {name: figures_of_all(one, asked) for name, one in parts.items() if name != ALL}
                data |= {"per": str(per), "parts": split}
            return data | ({"plots": [str(path) for path in drawn]} if drawn else {})

        output.results(to_json, show_text)


def plot_runs(options: "ScoreOptions", score: Score) -> Callable[[Path, "Groups"], Sequence[Path]]:
    """Return a function that plots identity kept and HOTA of grouped runs into a folder."""

    def draw(folder: Path, groups: "Groups") -> list[Path]:
        from peopleboy.scenarios.scores.people_ranges import VISIBLE_RANGES
        from peopleboy.scenarios.scores.tables.score_plots import draw_plots, occlusions_of

        named = {tracker: [Path(run.name) for run in runs] for tracker, runs in groups.items()}
        occlusions = {tracker: occlusions_of(runs, options) for tracker, runs in named.items()}
        return draw_plots(folder, occlusions, [score(one) for one in VISIBLE_RANGES])

    return draw


def table_options(command: Callable[..., None]) -> Callable[..., None]:
    """Add options for tables and plots; the command receives a `TableOptions` named `table`."""

    @wraps(command)
    def with_table(
        *arguments: Any, per: str | None, metrics: str | None, plots: Path | None, **options: Any
    ) -> None:
        from peopleboy.tracker.evaluation.table import parse_figures

        forms = [form for form in _FORMS if options.pop(form)]
        asked = [*forms, *(["json"] if options["as_json"] else [])]
        if len(asked) > 1:
            raise BadInput(f"--{asked[0]} and --{asked[1]}: give one of them")
        figures = () if metrics is None else parse_figures(metrics)
        table = TableOptions(forms[0] if forms else None, per, figures, plots)
        command(*arguments, table=table, **options)

    decorated = click.option(
        "--plots",
        metavar="FOLDER",
        type=PATH,
        help="Plot identity kept over the length of full occlusions, and HOTA over the visible fraction, as "
        "SVG and PDF.",
    )(with_table)
    decorated = click.option(
        "--metrics",
        metavar="NAME,...",
        help="Metrics to print, such as HOTA,IDF1,IDSW; names are those that the command prints.  "
        "[default: all; in tables HOTA, DetA, AssA, IDF1, MOTA, IDSW]",
    )(decorated)
    decorated = click.option(
        "--per",
        type=click.Choice(_PER),
        help="Print a table with a part for each scenario, sequence or run, or for people by their visible "
        "fraction or by the length of their longest full occlusion.",
    )(decorated)
    for form, what in reversed(_FORMS.items()):
        decorated = click.option(f"--{form}", is_flag=True, help=f"Print {what}.")(decorated)
    return decorated
