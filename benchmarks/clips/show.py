"""Clips and trackers as a table, and as JSON for the page of results."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean
from typing import Final

import click

from benchmarks.clips.clip import CHOSEN_BY, Clip
from benchmarks.clips.watch import Watched
from benchmarks.tracker_ablation import print_row
from peopleboy.tracker.evaluation.evaluate import combine


@dataclass(frozen=True, slots=True, eq=False)
class ClipRow:
    """One tracker on one clip, all seeds together."""

    clip: Clip
    tracker: str
    watched: Sequence[Watched]

    def figures(self) -> dict[str, float]:
        """Name the figures; NaN for those that would need everybody annotated."""
        scores = combine([one.scores for one in self.watched])
        counts, clear = scores.counts, scores.mot.clear
        everybody = {
            "HOTA": scores.mot.hota.hota,
            "IDF1": scores.mot.identity.idf1,
            "MOTA": clear.mota,
            "CP": scores.thesis.cp,
            "false tracks per 1000": 1000.0 * counts.false_tracks / counts.frames,
        }
        if self.clip.given.is_single:
            everybody = dict.fromkeys(everybody, math.nan)
        return everybody | {
            "CR": scores.thesis.cr,
            "one id": scores.mot.identity.idr,
            "frames per s": 1.0 / max(mean(one.frame_s for one in self.watched), 1e-9),
        }


COLUMNS: Final[Mapping[str, str]] = {
    "HOTA": "{:.1f}",
    "IDF1": "{:.1f}",
    "MOTA": "{:.1f}",
    "CP": "{:.1f}",
    "CR": "{:.1f}",
    "one id": "{:.1f}",
    "false tracks per 1000": "{:.1f}",
    "frames per s": "{:.0f}",
}
"""How each figure is written, in the table's order."""


def print_rows(rows: Sequence[ClipRow]) -> None:
    """Print one Markdown table, and then which clips values were chosen by."""
    print_row("clip", ("frames", "tracker", *COLUMNS))
    print_row("---", ["---:", "---", *["---:"] * len(COLUMNS)])
    for row in rows:
        figures = row.figures()
        cells = [_cell(figures[name], form) for name, form in COLUMNS.items()]
        print_row(row.clip.name, (str(row.clip.frames), row.tracker, *cells))
    click.echo(f"\n{_split(rows)}")


def write_rows(rows: Sequence[ClipRow], path: Path) -> None:
    """Keep the figures as JSON: clip, tracker, figure."""
    content: dict[str, dict[str, dict[str, float | None]]] = {}
    for row in rows:
        figures = {name: None if math.isnan(one) else one for name, one in row.figures().items()}
        known = {"runs": len(row.watched), "frames": row.clip.frames}
        content.setdefault(row.clip.name, {})[row.tracker] = known | figures
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def _cell(value: float, form: str) -> str:
    return "" if math.isnan(value) else form.format(value)


def _split(rows: Sequence[ClipRow]) -> str:
    clips = {row.clip.name: row.clip for row in rows}

    def listed(keep: Callable[[str], bool]) -> str:
        return ", ".join(filter(keep, clips)) or "none"

    return (
        f"- values chosen by: {listed(lambda name: name in CHOSEN_BY)}\n"
        f"- only reported: {listed(lambda name: name not in CHOSEN_BY)}\n"
        f"- one person annotated of several: {listed(lambda name: clips[name].given.is_single)}"
    )
