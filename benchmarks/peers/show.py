"""Tables and a plot of a comparison."""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from benchmarks.compare import percents, print_table
from benchmarks.peers.compete import Result
from peopleboy.tracker.evaluation.evaluate import combine
from peopleboy.tracker.evaluation.occlusion_scores import LengthRow, by_length
from peopleboy.tracker.evaluation.table import to_json

Results = Mapping[str, Sequence[Result]]  # by tracker
KEPT_UP_TO = {"up to 1.5 s": 1.5, "all": np.inf}
_SPOT = 4.0
SHOWN = ("CP", "CR", "AA", "HOTA", "IDF1")
WIDTH = 130  # of the tables, in characters


def print_results(results: Results) -> None:
    """Print the metrics of every tracker over all sequences."""
    columns = [f"{name} %" for name in SHOWN] + ["IDSW", "false tracks", "kept %", "ms/frame"]
    print_table(["", *columns], ([name, *_figures(runs)] for name, runs in results.items()), WIDTH)


def _figures(runs: Sequence[Result]) -> Iterator[str]:
    scores = combine([run.scores for run in runs])
    yield from percents(scores, *SHOWN)
    yield str(scores.mot.clear.switches)
    yield str(scores.counts.false_tracks)
    tracked = [o for run in runs for o in run.occlusions if o.id_before is not None]
    yield f"{100.0 * np.mean([o.is_kept for o in tracked]):.0f} of {len(tracked)}" if tracked else "-"
    yield f"{np.median([run.ms for run in runs]):.1f}"


def print_occlusions(results: Results) -> None:
    """Print the share of kept identities, and the time until recovery, by duration of the occlusion."""
    rows = {name: by_length(_occlusions(runs)) for name, runs in results.items()}
    columns = [f"{row.from_s:g}..{row.to_s:g} s" for row in next(iter(rows.values()))]
    cells = ([name, *map(_cell, lengths)] for name, lengths in rows.items())
    print_table(["identity kept (found again after)", *columns], cells, WIDTH)


def write_results(results: Results, path: Path) -> None:
    """Write the metrics of every tracker over all sequences, and the kept identities, as JSON."""
    content = {
        name: {
            "runs": len(runs),
            "scores": to_json(combine([run.scores for run in runs])),
            "kept": {title: _kept(runs, to_s) for title, to_s in KEPT_UP_TO.items()},
        }
        for name, runs in results.items()
    }
    path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def _kept(runs: Sequence[Result], to_s: float) -> dict[str, float | None]:
    """Return the share of kept identities among occlusions shorter than a duration."""
    rows = [row for row in by_length(_occlusions(runs)) if row.to_s <= to_s]
    tracked = sum(row.occlusions for row in rows)
    return {"share": sum(row.kept for row in rows) / tracked if tracked else None, "occlusions": tracked}


def draw_occlusions(results: Results, path: Path) -> None:
    """Plot kept identities and recovery time over the duration of the occlusion, and save the plot."""
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    FigureCanvasAgg(figure)
    kept, found = figure.subplots(1, 2)
    for name, runs in results.items():
        rows = [row for row in by_length(_occlusions(runs)) if row.occlusions]
        at = [_middle(row) for row in rows]
        style = "--" if "+" in name else "-"
        kept.plot(at, [100.0 * row.kept_share for row in rows], style, marker="o", ms=_SPOT, label=name)
        found.plot(at, [row.found_after_s for row in rows], style, marker="o", ms=_SPOT)
    for axes, title in ((kept, "identity kept [%]"), (found, "found again after, median [s]")):
        axes.set_title(title, fontsize=10)
        axes.set_xlabel("duration of total occlusion [s]")
        axes.set_xscale("log")
        axes.set_xticks([0.2, 0.5, 1, 2, 5, 8], ["0.2", "0.5", "1", "2", "5", "8"])
        axes.minorticks_off()
        axes.grid(alpha=0.3)
    kept.set_ylim(-3.0, 103.0)
    figure.legend(loc="outside right center", fontsize=8)
    figure.savefig(path, dpi=130)


def _occlusions(runs: Sequence[Result]) -> list[object]:
    return [occlusion for run in runs for occlusion in run.occlusions]


def _cell(row: LengthRow) -> str:
    if not row.occlusions:
        return "-"
    return f"{100.0 * row.kept_share:.0f} % of {row.occlusions} ({row.found_after_s:.1f} s)"


def _middle(row: LengthRow) -> float:
    """Return the duration at which to plot a range."""
    return row.from_s * 1.3 if np.isinf(row.to_s) else max((row.from_s + row.to_s) / 2.0, 0.1)
