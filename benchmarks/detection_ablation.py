"""What each part of the tracker by detection gives: `python -m benchmarks.detection_ablation`.

Scenes and random worlds are recorded once, and people proposed once; every variant then sees the same.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import click
import numpy as np

from benchmarks.tracker_ablation import Recorded, print_row, record, recorded
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.tracker.by_detection.by_detection_tracker import ByDetectionTracker
from peopleboy.tracker.by_detection.colour_finder import ColourFinder, seen_by_both
from peopleboy.tracker.by_detection.config import BothCamerasConfig, ByDetectionConfig
from peopleboy.tracker.by_detection.finder import ThermalFinder
from peopleboy.tracker.evaluation.evaluate import Scores, combine, evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.proposals.suppression import Proposals

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
_SEEN: Final = 0.3
_ALL: Final = ByDetectionConfig()

VARIANTS: Final[Mapping[str, ByDetectionConfig]] = {
    "as it is": _ALL,
    "by the thermal image alone": replace(_ALL, colour=replace(_ALL.colour, same=math.inf, alone=math.inf)),
    "everybody is 1.72 m tall": replace(_ALL, path=replace(_ALL.path, build=1e-3, posture=0.0)),
    "nested boxes are as good": replace(_ALL, existence=replace(_ALL.existence, shared_doubt=0.0)),
    "no late decisions": replace(_ALL, identity=replace(_ALL.identity, parted_s=math.inf, gone_s=math.inf)),
}


@dataclass(frozen=True, slots=True, eq=False)
class Proposed:
    """A run, and who was proposed in its frames, by the thermal image and by the colour image."""

    run: Recorded
    proposals: tuple[tuple[Proposals, Proposals], ...]

    @classmethod
    def of(cls, run: Recorded) -> Proposed:
        """Look for people once."""
        thermal = ThermalFinder(_ALL.existence.weakest)
        colour = ColourFinder(_ALL.colour, _ALL.existence.weakest)
        return cls(run, tuple((thermal(frame), colour(frame)) for frame in run.frames))


class Told:
    """Finds what was proposed before, frame by frame."""

    def __init__(self, film: Proposed, config: BothCamerasConfig) -> None:
        """Begin with the first frame."""
        self._proposals = iter(film.proposals)
        self._config = config

    def __call__(self, frame: Frame) -> Proposals:  # noqa: ARG002
        """Give what was proposed in the next frame."""
        return seen_by_both(*next(self._proposals), self._config)


def tracked(film: Proposed, config: ByDetectionConfig) -> TrackBoxes:
    """Follow people in a film."""
    tracker = ByDetectionTracker(config, Told(film, config.colour))
    found = [
        (number, track)
        for number, frame in enumerate(film.run.frames, start=1)
        for track in tracker.update(frame)
    ]
    return TrackBoxes(
        frame=np.array([number for number, _ in found], int),
        id=np.array([track.id for _, track in found], int),
        box=np.array([track.boxes[THERMAL] for _, track in found]).reshape(-1, 4),
        confidence=np.array([track.confidence for _, track in found], float),
    )


def figures(scenes: Sequence[Proposed], worlds: Sequence[Proposed], config: ByDetectionConfig) -> list[str]:
    """Give one row, as `COLUMNS` names it; of worlds the mean over those in which somebody is to be found."""
    library = combine([_scores(film, tracked(film, config)) for film in scenes])
    ways = [(film, tracked(film, config)) for film in worlds]
    everybody = [_scores(*way) for way in ways]
    seen = [_scores(*way, min_visible=_SEEN) for way in ways]
    counts = combine(everybody).counts
    return [
        f"{library.mot.hota.hota:.1f}",
        f"{library.mot.identity.idf1:.1f}",
        str(library.mot.clear.switches),
        *(f"{np.nanmean([one.mot.hota.hota for one in scores]):.1f}" for scores in (everybody, seen)),
        f"{1000.0 * counts.false_tracks / counts.frames:.2f}",
    ]


def _scores(film: Proposed, tracks: TrackBoxes, min_visible: float = 0.0) -> Scores:
    return evaluate(film.run.truth, tracks, frames=len(film.run.frames), min_visible=min_visible)


@click.command()
@click.option("--seed", default=1, show_default=True, help="Of the scenes.")
@click.option(
    "--worlds", type=click.IntRange(min=1), default=30, show_default=True, help="How many, from 0 on."
)
def main(seed: int, worlds: int) -> None:
    """Print how the tracker does as it is, and without each of its parts, as a Markdown table."""
    scenes = [Proposed.of(record(name, seed)) for name in SCENES]
    drawn = [Proposed.of(recorded(random_scenario(number), number)) for number in range(worlds)]
    print_row("", COLUMNS)
    print_row("---", ["---:"] * len(COLUMNS))
    for name, config in VARIANTS.items():
        print_row(name, figures(scenes, drawn, config))


if __name__ == "__main__":
    main()
