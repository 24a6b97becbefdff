"""What each part of the tracker by detection gives: `python -m benchmarks.detection_ablation`.

Scenes and random worlds are recorded once; every variant then sees the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import click

from benchmarks import call
from benchmarks.clips.clip import CHOSEN_BY, open_clips
from benchmarks.detection_ablation.film import Film
from benchmarks.detection_ablation.variants import VARIANTS, Variant
from benchmarks.tracker_ablation import print_row, record, recorded
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.tracker.evaluation.evaluate import Scores, combine

SCENES: Final = (
    "crossing_4",
    "behind_wall_edge",
    "stop_and_talk",
    "leader_swap",
    "hidden_2s",
    "turn_while_hidden",
    "sitting",
    "crowd_8",
)
COLUMNS: Final = (
    "library: HOTA",
    "IDF1",
    "switches",
    "worlds: HOTA",
    "of those seen",
    "false per 1000 frames",
)
COLUMNS_OF_CLIPS: Final = ("clips: HOTA", "false per 1000 frames")
_SEEN: Final = 0.3


def of_worlds(scenes: Sequence[Film], worlds: Sequence[Film], variant: Variant) -> list[str]:
    """Give a row's figures, as `COLUMNS` names them."""
    library = combine([film.score(variant.tracked(film)) for film in scenes])
    ways = [(film, variant.tracked(film)) for film in worlds]
    everybody = combine([film.score(way) for film, way in ways])
    seen = combine([film.score(way, min_visible=_SEEN) for film, way in ways])
    return [
        f"{library.mot.hota.hota:.1f}",
        f"{library.mot.identity.idf1:.1f}",
        str(library.mot.clear.switches),
        f"{everybody.mot.hota.hota:.1f}",
        f"{seen.mot.hota.hota:.1f}",
        _false(everybody),
    ]


def of_clips(clips: Sequence[Film], variant: Variant) -> list[str]:
    """Give a row's figures, as `COLUMNS_OF_CLIPS` names them."""
    scores = combine([film.score(variant.tracked(film)) for film in clips])
    return [f"{scores.mot.hota.hota:.1f}", _false(scores)]


def _false(scores: Scores) -> str:
    return f"{1000.0 * scores.counts.false_tracks / scores.counts.frames:.2f}"


@click.command()
@click.option("--seed", default=1, show_default=True, help="Of the scenes.")
@click.option(
    "--worlds", type=click.IntRange(min=1), default=30, show_default=True, help="How many, from 0 on."
)
@click.option(
    "--clips",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Folder of clips, of which those are taken by which values may be chosen.",
)
def main(seed: int, worlds: int, clips: Path | None) -> None:
    """Print how the tracker does as it is, and without each of its parts, as a Markdown table."""
    real = [] if clips is None else [Film.of_clip(clip) for clip in open_clips(clips, CHOSEN_BY)]
    scenes = [Film.of_run(record(name, seed)) for name in SCENES]
    drawn = [Film.of_run(recorded(random_scenario(number), number)) for number in range(worlds)]
    columns = (*COLUMNS, *(COLUMNS_OF_CLIPS if real else ()))
    print_row("", columns)
    print_row("---", ["---:"] * len(columns))
    for name, variant in VARIANTS.items():
        print_row(name, [*of_worlds(scenes, drawn, variant), *(of_clips(real, variant) if real else ())])


if __name__ == "__main__":
    call(main, "benchmarks.detection_ablation")
