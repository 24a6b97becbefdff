"""The page that sets rendered pictures beside real ones, in one file that needs nothing else."""

from __future__ import annotations

from pathlib import Path

import jinja2

from peopleboy.scenarios.report.page_file import write_page
from peopleboy.scenarios.sim_to_real.charts import draw_charts, grid
from peopleboy.scenarios.sim_to_real.clips import ROWS
from peopleboy.scenarios.sim_to_real.compare import PICTURES, Comparison, Side, figures_of
from peopleboy.scenarios.sim_to_real.tell_apart import Told

HERE = Path(__file__).parent
_STYLE = HERE.parent / "report"


def write_comparison(comparison: Comparison, out: Path) -> None:
    """Write the page, whole or not at all.

    Raises:
        BadInput: it cannot be written there.
    """
    write_page(render_comparison(comparison), out)


def render_comparison(comparison: Comparison) -> str:
    """Write the page as HTML."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([HERE, _STYLE]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    sides = {"rendered": comparison.rendered, "real": comparison.real}
    return environment.get_template("comparison.html.jinja").render(
        headline=headline(comparison),
        comparison=comparison,
        rows=[row for name, side in sides.items() for row in table_rows(name, side)],
        heads=HEADS,
        charts=draw_charts(comparison),
        grids=[
            (f"{what}, {name}", grid(patches))
            for what, of in (("Background", "background"), ("People", "people"))
            for name, side in sides.items()
            for patches in (getattr(side, of),)
        ],
        view_rows=ROWS,
        pictures=PICTURES,
    )


def headline(comparison: Comparison) -> str:
    """Say how well patches are told apart."""
    told, people = comparison.told, comparison.told_people
    said = f"Rendered and real patches are told apart with an AUC of {auc_words(told)}"
    return f"{said}, people with {auc_words(people)}." if people is not None else f"{said}."


def auc_words(told: Told) -> str:
    """A mean and its interval."""
    return f"{told.auc.mean:.3f} ({told.auc.low:.3f} to {told.auc.high:.3f})"


def table_rows(name: str, side: Side) -> list[tuple[str, ...]]:
    """Figures of a side, then of each of its scenes."""
    pictures = sum(scene.pictures for scene in side.scenes)
    people = sum(scene.people for scene in side.scenes)
    rows = [(f"{name}, all", pictures, people, figures_of(side.looks))]
    rows += [(scene.name, scene.pictures, scene.people, figures_of(scene.looks)) for scene in side.scenes]
    return [
        (
            label,
            str(count),
            str(persons),
            f"{figures['background_deviation']:.1f}",
            _or_nothing(figures["noise"], ".1f"),
            f"{100.0 * (figures['share_clipped'] or 0.0):.1f}",
            _or_nothing(figures["contrast_median"], ".0f"),
            _or_nothing(figures["contrast_in_ring_median"], ".1f"),
        )
        for label, count, persons, figures in rows
    ]


HEADS = (
    "scene",
    "pictures",
    "people",
    "deviation of background [grey]",
    "noise [grey]",
    "clipped [%]",
    "contrast of people [grey]",
    "in deviations of the ring",
)
"""Of the columns of `table_rows`."""


def _or_nothing(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)
