"""How many people of each posture are tracked and named: `python -m benchmarks.postures`.

Random worlds in which people sit, bend, crouch and lie, of seeds that the training does not use. With
`--tracker detection+FILE.npz`, those of a network of `peopleboy train people`, which names postures.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import click
import numpy as np
from numpy.typing import NDArray

from benchmarks import call
from benchmarks.compare import print_table, rows_of, update_results
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.world import SimulatedWorld
from peopleboy.studies.training.detector.people_samples import POSTURE_OF
from peopleboy.studies.training.detector.worlds import ordinary_world
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import TrackPosture, confirmed
from peopleboy.tracker.trackers import DEFAULT_TRACKER, make_tracker

OUT: Final = Path("runs/postures.json")
FIRST_SEED: Final = 300
COLUMNS: Final[Mapping[str, str]] = {
    "people": "{:.0f}", "tracked": "{:.1f} %", "named": "{:.1f} %", "false boxes per image": "{:.3f}",
}  # fmt: skip
"""Columns of the table, with the format of their values."""

_NUMBER_OF: Final = {str(posture): POSTURE_OF[k] for k, posture in enumerate(Posture)}
_ON_PERSON: Final = 0.5  # IoU
_VISIBLE: Final = 0.5  # least visible share of a person who counts
_SHORTEST_PX: Final = 12.0  # least height of the box of a person who counts

Counts = NDArray[np.int64]
"""(3, 5) people, tracked people, and people with the right posture."""


def count(tick: Tick) -> tuple[Counts, int]:
    """Return the counts of one image, and the number of boxes on no person."""
    tracks = list(confirmed(tick.tracks, THERMAL))
    people = [person for person in tick.truth.people if person.box is not None and person.visible_px]
    boxes = np.array([box for _, box in tracks]).reshape(-1, 4)
    overlap = iou(np.array([person.box for person in people]).reshape(-1, 1, 4), boxes[None])
    counts = np.zeros((3, len(TrackPosture)), np.int64)
    for person, row in zip(people, overlap, strict=True):
        assert person.box is not None
        if person.visible_fraction < _VISIBLE or person.box[3] < _SHORTEST_PX:
            continue
        number = _NUMBER_OF[person.posture]
        counts[0, number] += 1
        if len(row) and row.max() >= _ON_PERSON:
            counts[1, number] += 1
            counts[2, number] += tracks[int(row.argmax())][0].posture == list(TrackPosture)[number]
    return counts, int((overlap.max(axis=0, initial=0.0) < _ON_PERSON / 2.0).sum())


def table_of(counts: Counts, images: int, false_boxes: int) -> dict[str, dict[str, float | None]]:
    """Return the values of `COLUMNS` for each posture, and for all."""
    rows: dict[str, dict[str, float | None]] = {}
    every = {**dict(zip(TrackPosture, counts.T, strict=True)), "all": counts.sum(axis=1)}
    for name, (people, tracked, named) in every.items():
        rows[str(name)] = {
            "people": float(people),
            "tracked": 100.0 * float(tracked) / people if people else None,
            "named": 100.0 * float(named) / tracked if tracked else None,
            "false boxes per image": false_boxes / images if name == "all" else None,
        }
    return rows


@click.command()
@click.option("--worlds", type=click.IntRange(1, 200), default=20, show_default=True, help="Random worlds.")
@click.option("--tracker", "trackers", multiple=True, default=(DEFAULT_TRACKER,), show_default=True)
def main(worlds: int, trackers: tuple[str, ...]) -> None:
    """Print the share of people that are tracked, and of these the share named correctly, by posture.

    The results are also written to runs/postures.json.
    """
    found: dict[str, dict[str, float | None]] = {}
    for name in trackers:
        counts, images, false_boxes = np.zeros((3, len(TrackPosture)), np.int64), 0, 0
        for seed in range(FIRST_SEED, FIRST_SEED + worlds):
            scenario = parse_scenario(ordinary_world(seed), source=f"world {seed}", folder=Path())
            frames = round(scenario.duration_s * scenario.world(seed).control_hz)
            with SimulatedWorld(scenario.world(seed)) as world:
                for tick in closed_loop(world, make_tracker(name), scenario.make_behaviour(), frames):
                    one, wrong = count(tick)
                    counts, images, false_boxes = counts + one, images + 1, false_boxes + wrong
        rows = table_of(counts, images, false_boxes)
        found |= {f"{name}, {posture}": row for posture, row in rows.items()}
    print_table(("tracker and posture", *COLUMNS), rows_of(found, COLUMNS), width=110)
    update_results(OUT, found)


if __name__ == "__main__":
    call(main, "benchmarks.postures")
