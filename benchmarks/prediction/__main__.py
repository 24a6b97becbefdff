"""Prediction of where people walk, in unseen worlds: `python -m benchmarks.prediction`.

Each world runs once with a tracker. The same people are predicted from their true tracks and from those of
the tracker.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import click
import numpy as np

from benchmarks import call
from benchmarks.compare import compare, print_table, rows_of, update_results
from benchmarks.prediction.prediction_metrics import PredictionScore, score_predictions
from benchmarks.prediction.prediction_task import Errors, PredictionTask
from peopleboy.scenarios.running.engine.task import chosen_workers
from peopleboy.tracker.trackers import DEFAULT_TRACKER

OUT: Final = Path("runs/prediction.json")
FIRST_WORLD: Final = 3000
"""First of the random worlds: no setting was chosen on these."""
COLUMNS: Final[Mapping[str, str]] = {
    "predictions": "{:.0f}", "ADE": "{:.2f} m", "FDE": "{:.2f} m", "misses": "{:.1f} %",
    "in ellipse": "{:.1f} %",
}  # fmt: skip
"""Columns of the table, with the format of their values."""


def summarise(score: PredictionScore) -> dict[str, float | None]:
    """Return a score by the titles of `COLUMNS`; None where there is no prediction."""
    values = score.predictions, score.ade_m, score.fde_m, 100.0 * score.miss, 100.0 * score.inside
    return {name: None if np.isnan(value) else value for name, value in zip(COLUMNS, values, strict=True)}


@click.command()
@click.option(
    "--worlds",
    type=click.IntRange(min=0, max=10_000),
    default=40,
    show_default=True,
    help="number of random worlds",
)
@click.option("--tracker", default=DEFAULT_TRACKER, show_default=True, help="tracker beside the true tracks")
@click.option("--workers", type=click.IntRange(min=1), default=None, help="processes; default one per core")
def main(worlds: int, tracker: str, workers: int | None) -> None:
    """Predict people in unseen worlds; print the errors after 1, 2, 3 and 5 s.

    A miss is an error of more than 2 m. The results are also written to runs/prediction.json.
    """
    numbers = range(FIRST_WORLD, FIRST_WORLD + worlds)
    tasks = {tracker: [PredictionTask(number, tracker) for number in numbers]}
    (parts,) = compare(tasks, chosen_workers(workers, None), "worlds").values()
    found = {}
    for key in parts[0]:
        errors = Errors(*(np.concatenate(part) for part in zip(*(one[key] for one in parts), strict=True)))
        for horizon_s, score in score_predictions(*errors).items():
            found[f"{key}, {horizon_s:g} s"] = summarise(score)
    print_table(("tracks, after", *COLUMNS), rows_of(found, COLUMNS), width=120)
    update_results(OUT, found)


if __name__ == "__main__":
    call(main, "benchmarks.prediction")
