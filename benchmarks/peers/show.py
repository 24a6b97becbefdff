"""Tables and a plot of a comparison."""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from benchmarks.compare import percents, print_table
from benchmarks.peers.compete import Result
from peopleboy.scenarios.scores.tables.score_plots import draw_identity_kept
from peopleboy.tracker.evaluation.evaluate import combine
from peopleboy.tracker.evaluation.occlusion_scores import LengthRow, Occlusion, by_length
from peopleboy.tracker.evaluation.table import to_json

Results = Mapping[str, Sequence[Result]]  # by tracker
KEPT_UP_TO = {"up to 1.5 s": 1.5, "all": np.inf}
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


def draw_occlusions(results: Results, folder: Path) -> list[Path]:
    """Plot kept identities over the duration of the occlusion, and return the paths."""
    return draw_identity_kept(folder, {name: _occlusions(runs) for name, runs in results.items()})


def _occlusions(runs: Sequence[Result]) -> list[Occlusion]:
    return [occlusion for run in runs for occlusion in run.occlusions]


def _cell(row: LengthRow) -> str:
    if not row.occlusions:
        return "-"
    return f"{100.0 * row.kept_share:.0f} % of {row.occlusions} ({row.found_after_s:.1f} s)"
