"""Plots for papers: identity kept over the length of occlusions, and HOTA over the visible fraction."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy import stats

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import cameras_of, read_run
from peopleboy.scenarios.scores.bootstrap import LEVEL, Interval
from peopleboy.scenarios.scores.by_tracker import Groups
from peopleboy.scenarios.scores.evaluate_runs import ScoreOptions, read_reference_boxes, reference_of
from peopleboy.scenarios.scores.people_ranges import VISIBLE_RANGES, occluded_in
from peopleboy.scenarios.scores.summaries import summarise
from peopleboy.scenarios.scores.tables.score_table import keep_targets
from peopleboy.sim.world_config import CONTROL_HZ
from peopleboy.tracker.evaluation.occlusion_scores import LENGTHS_S, Occlusion, by_length, score_occlusions
from peopleboy.tracker.evaluation.table import parse_figures
from peopleboy.tracker.frame import THERMAL

FORMATS: Final = ("svg", "pdf")
_SIZE_IN: Final = (3.5, 2.6)  # one column of a paper
_APART: Final = 0.12  # between the points of two trackers, in ranges
_COLOURS: Final = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")  # Okabe, Ito
_MARKERS: Final = ("o", "s", "^", "D", "v", "P", "X")  # which stay distinct in print


class PlotSeries(NamedTuple):
    """One tracker's values by range; the ranges without a value are left out."""

    at: Sequence[int]
    values: Sequence[Interval]


def identity_kept(occlusions: Sequence[Occlusion]) -> PlotSeries:
    """Return the share of kept identities [%] by length of the occlusion, with 95 % Wilson intervals."""
    rows = by_length(occlusions)
    at = [number for number, row in enumerate(rows) if row.occlusions]
    return PlotSeries(at, [_share(rows[number].kept, rows[number].occlusions) for number in at])


def _share(kept: int, of: int) -> Interval:
    between = stats.binomtest(kept, of).proportion_ci(LEVEL, method="wilson")
    return Interval(100.0 * kept / of, 100.0 * between.low, 100.0 * between.high)


def hota_by_visibility(groups: Sequence[Groups], tracker: str) -> PlotSeries:
    """Return the mean HOTA [%] over runs by visible fraction, with 95 % bootstrap intervals.

    Args:
        groups: the runs, scored for each of `VISIBLE_RANGES`.
        tracker: name of the tracker.
    """
    hota = parse_figures("HOTA")
    runs = [keep_targets(of_range).get(tracker, ()) for of_range in groups]
    at = [number for number, of_range in enumerate(runs) if of_range]
    return PlotSeries(at, [summarise([run.scores for run in runs[k]], hota)[0].interval for k in at])


def draw_series(axes: Axes, series: Mapping[str, PlotSeries], ranges: Sequence[str]) -> None:
    """Draw the values of trackers [%] with their intervals over named ranges."""
    middle = (len(series) - 1) / 2.0
    for number, (tracker, (at, values)) in enumerate(series.items()):
        x = [place + _APART * (number - middle) for place in at]
        means = [one.mean for one in values]
        colour, marker = _COLOURS[number % len(_COLOURS)], _MARKERS[number % len(_MARKERS)]
        axes.plot(x, means, color=colour, marker=marker, markersize=4, linewidth=1.0, label=tracker)
        known = [(place, one) for place, one in zip(x, values, strict=True) if one.is_known]
        axes.vlines(
            [place for place, _ in known],
            [one.low for _, one in known],
            [one.high for _, one in known],
            color=colour,
            linewidth=0.8,
        )
    axes.set_xticks(range(len(ranges)), ranges)
    axes.set_xlim(-0.5, len(ranges) - 0.5)
    axes.set_ylim(-3.0, 103.0)
    axes.grid(axis="y", alpha=0.3, linewidth=0.5)


def draw_plots(
    folder: Path, occlusions: Mapping[str, Sequence[Occlusion]], by_visibility: Sequence[Groups]
) -> list[Path]:
    """Write both plots as SVG and PDF, and return their paths.

    Args:
        folder: folder of the plots.
        occlusions: full occlusions by tracker.
        by_visibility: the runs, scored for each of `VISIBLE_RANGES`.
    """
    hota = {tracker: hota_by_visibility(by_visibility, tracker) for tracker in occlusions}
    fractions = [f"{100 * one.low:.0f}-{100 * one.high:.0f}" for one in VISIBLE_RANGES]
    folder.mkdir(parents=True, exist_ok=True)
    return [
        *draw_identity_kept(folder, occlusions),
        *_save(folder / "hota_by_visibility", hota, fractions, ("visible fraction [%]", "HOTA [%]")),
    ]


def draw_identity_kept(folder: Path, occlusions: Mapping[str, Sequence[Occlusion]]) -> list[Path]:
    """Write the plot of identities kept through full occlusions, by tracker, and return its paths."""
    kept = {tracker: identity_kept(of_tracker) for tracker, of_tracker in occlusions.items()}
    lengths = [f"< {high:g}" for high in LENGTHS_S[1:-1]] + [f"> {LENGTHS_S[-2]:g}"]
    return _save(folder / "identity_kept", kept, lengths, ("full occlusion [s]", "identity kept [%]"))


def _save(
    path: Path, series: Mapping[str, PlotSeries], ranges: Sequence[str], labels: tuple[str, str]
) -> list[Path]:
    # The salt makes the bytes of an SVG file repeatable, and type 42 keeps the text of a PDF file as text.
    with mpl.rc_context({"svg.hashsalt": path.name, "pdf.fonttype": 42, "font.size": 8}):
        figure = Figure(figsize=_SIZE_IN, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots()
        draw_series(axes, series, ranges)
        axes.set(xlabel=labels[0], ylabel=labels[1])
        if len(series) > 1:
            axes.legend(frameon=False, fontsize=7)
        paths = [path.with_suffix(f".{form}") for form in FORMATS]
        for one, no_date in zip(paths, ({"Date": None}, {"CreationDate": None}), strict=True):
            figure.savefig(one, metadata=no_date)
    return paths


# Full occlusions of finished runs, and the identities that were kept through them.


def occlusions_of(folders: Sequence[Path], options: ScoreOptions) -> list[Occlusion]:
    """Return the identity outcome of every full occlusion in some runs.

    Raises:
        BadInput: a run is not one of a scenario, or its files are unreadable.
    """
    return [occlusion for folder in folders for occlusion in _occlusions_in(folder, options)]


def _occlusions_in(folder: Path, options: ScoreOptions) -> list[Occlusion]:
    about = read_run(folder)
    if not (folder / "truth.parquet").is_file():
        raise BadInput(f"--plots: {folder} has no scenario tables, which state the occlusions; leave it out")
    by = reference_of(folder, about, options)
    every = 1
    if by.camera != THERMAL:
        every = CONTROL_HZ // (cameras_of(folder)[by.camera].rate_hz or CONTROL_HZ)
    truth, tracks = read_reference_boxes(folder, by)
    return score_occlusions(truth, tracks, occluded_in(folder, by.camera, truth, every))
