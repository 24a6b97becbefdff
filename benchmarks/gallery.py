"""How well people of earlier runs are recognised: `python -m benchmarks.gallery SCENARIO`.

The scenario runs once per seed, with one gallery for all runs. The first visit of each person gives the right
id: the most frequent one of the tracks on the person. Later visits are scored by it.
"""

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import click

from benchmarks import call
from benchmarks.compare import print_table, rows_of, update_results
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.scores.following_metrics import Spot, track_on
from peopleboy.tracker.trackers import DEFAULT_TRACKER

OUT: Final = Path("runs/gallery.json")
COLUMNS: Final[Mapping[str, str]] = {
    "later visits": "{}", "right": "{}", "boxes": "{}", "right id": "{:.1f} %", "wrong person": "{:.1f} %",
    "new id": "{:.1f} %",
}  # fmt: skip
"""Columns of the table, with the format of their values."""

Visit = dict[str, Counter[int]]
"""Number of boxes by id of the track, for each person."""


class VisitWatch:
    """Counts the frames in which each id is on each person, tick by tick."""

    def __init__(self) -> None:
        self.visit: Visit = defaultdict(Counter)

    def __call__(self, tick: Tick, _frames: int) -> None:
        """Add a tick."""
        for person in tick.truth.people:
            if person.box is not None and person.is_counted:
                place_m = tick.truth.robot.to_local(person.position_m)
                track = track_on(Spot(person.box, place_m), tick.tracks)
                if track:
                    self.visit[person.name][track] += 1


def score(visits: Sequence[Visit]) -> dict[str, float]:
    """Return the values of `COLUMNS` for visits in their order.

    An id belongs to the person with most of its boxes at the first visits.
    """
    first: dict[str, Counter[int]] = {}
    later: list[tuple[str, Counter[int]]] = []
    for visit in visits:
        later += [(name, ids) for name, ids in visit.items() if name in first]
        first = dict(visit) | first
    count = {(number, name): n for name, ids in first.items() for number, n in ids.items()}
    person = {number: name for _, (number, name) in sorted((n, key) for key, n in count.items())}
    boxes = sum(ids.total() for _, ids in later)
    right = sum(n for name, ids in later for number, n in ids.items() if person.get(number) == name)
    new = sum(n for _, ids in later for number, n in ids.items() if number not in person)
    return {
        "later visits": len(later),
        "right": sum(person.get(ids.most_common(1)[0][0]) == name for name, ids in later),
        "boxes": boxes,
        "right id": 100.0 * right / max(boxes, 1),
        "wrong person": 100.0 * (boxes - right - new) / max(boxes, 1),
        "new id": 100.0 * new / max(boxes, 1),
    }


@click.command()
@click.argument("scenario")
@click.option("--seeds", type=click.IntRange(min=2, max=1000), default=10, show_default=True, help="runs")
@click.option("--tracker", default=DEFAULT_TRACKER, show_default=True)
def main(scenario: str, seeds: int, tracker: str) -> None:
    """Run a scenario with one gallery for all seeds; print how often people get their first id.

    The results are also written to runs/gallery.json.
    """
    loaded, visits = load_scenario(scenario), []
    with TemporaryDirectory() as folder:
        for seed in range(seeds):
            options = RunOptions(
                seed=seed,
                out=Path(folder) / str(seed),
                tracker=tracker,
                record=False,
                gallery=Path(folder) / "people.json",
            )
            watch = VisitWatch()
            run(loaded, options, watch)
            visits.append(watch.visit)
    found = {loaded.name: score(visits)}
    print_table(("scenario", *COLUMNS), rows_of(found, COLUMNS), width=120)
    update_results(OUT, found)


if __name__ == "__main__":
    call(main, "benchmarks.gallery")
