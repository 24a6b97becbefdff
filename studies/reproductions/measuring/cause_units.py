"""What a tracker's errors are due to: its scores with one cause of them after the other set aside."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.running.frame_cache import Film, film
from peopleboy.sim.random_streams import stream
from peopleboy.sim.truth.truth import COUNTED_FARTHEST_M, COUNTED_NEAREST_M
from peopleboy.studies.reproductions.measuring.units import Showing, track_film
from peopleboy.tracker.evaluation.area_metrics import measure_paper, measure_thesis
from peopleboy.tracker.evaluation.box_matching import associate, counts, ignore_uncounted, pair_up
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

Flags = NDArray[np.bool_]

STRICT, NEAR, FAR, RANGE = "strict", "strict, near aside", "strict, far aside", "strict, near and far aside"
HALF, FOUND = "half in view", "once found"
WAYS: Final = ("", STRICT, NEAR, FAR, RANGE, HALF, FOUND)
"""Ways to count; "" is the usual one.

Strictly, whoever is not counted is not there, and who is wholly hidden neither. "near aside" sets aside boxes
on people nearer than the sources count, "far aside" on those farther, by the truth's distance. "half in view"
sets aside who is less than half in view, and boxes on them; "once found" people until they are first found.
"""
STRETCH: Final = 15  # frames without a person after which it is somebody who has yet to be found


@dataclass(frozen=True, slots=True, eq=False)
class CauseUnit(Showing):
    """Let a tracker see a film, and count what it finds in all of these ways."""

    @property
    def key(self) -> str:
        """What is shown to whom."""
        return f"causes {self.parts}"

    def run(self) -> Result:
        """Track, with the random numbers of `units.TrackUnit`, and score."""
        shot = film(self.play.scenario, self.play.seed, self.cache)
        found, _ = track_film(shot, self.setting.make(stream(self.repeat, "reproduce.tracker")))
        ways = ways_to_count(shot.truth(), distances_of(shot), found)
        return {way: _scored(truth, found) for way, truth in ways.items()}


def distances_of(shot: Film) -> NDArray[np.float64]:
    """Give how far each row (N,) of a film's truth is from the camera on the floor [m]."""
    people, truth = shot.people(), shot.truth()
    columns = (people[name].to_pylist() for name in ("frame", "id", "distance_m"))
    known = {(frame, person): distance for frame, person, distance in zip(*columns, strict=True)}
    return np.array([known[row] for row in zip(truth.frame.tolist(), truth.id.tolist(), strict=True)])


def ways_to_count(
    truth: TrueBoxes, distance_m: NDArray[np.float64], found: TrackBoxes
) -> dict[str, TrueBoxes]:
    """Give the truth as each way has it: who is not in it is not there, who is not counted is set aside.

    Args:
        truth: of a film.
        distance_m: (N,) of each of its rows from the camera.
        found: what a tracker found there.
    """
    is_target = counts(truth.counted, truth.visible)
    usual = replace(truth, counted=is_target)
    is_near = distance_m < COUNTED_NEAREST_M
    is_far = distance_m > COUNTED_FARTHEST_M
    return {
        "": usual,
        STRICT: usual.take(is_target),
        NEAR: usual.take(is_target | is_near),
        FAR: usual.take(is_target | is_far),
        RANGE: usual.take(is_target | is_near | is_far),
        HALF: replace(truth, counted=counts(truth.counted, truth.visible, 0.5)),
        FOUND: replace(truth, counted=is_target & ~not_yet_found(usual, found)),
    }


def not_yet_found(truth: TrueBoxes, found: TrackBoxes) -> Flags:
    """Tell which rows (N,) are of people who come into view, counted, and have not been found since."""
    targets = truth.take(truth.counted)
    pairs = pair_up(targets, found)
    is_hit = np.zeros(len(targets), dtype=np.bool_)
    is_hit[pairs.target[associate(pairs)]] = True
    is_early = np.zeros(len(targets), dtype=np.bool_)
    for person in np.unique(targets.id):
        rows = np.flatnonzero(targets.id == person)
        rows = rows[np.argsort(targets.frame[rows])]
        comes = np.flatnonzero(np.diff(targets.frame[rows]) > STRETCH) + 1
        for stretch in np.split(rows, comes):
            is_early[stretch] = np.cumsum(is_hit[stretch]) == 0
    early = np.zeros(len(truth), dtype=np.bool_)
    early[np.flatnonzero(truth.counted)] = is_early
    return early


def _scored(truth: TrueBoxes, found: TrackBoxes) -> Result:
    judged = ignore_uncounted(truth, found)
    pairs = pair_up(judged.truth, judged.tracks)
    return {
        "paper": asdict(measure_paper(judged.truth, judged.tracks, pairs)),
        "thesis": asdict(measure_thesis(judged.truth, judged.tracks, pairs, associate(pairs))),
        "boxes": len(judged.tracks),
        "people": len(judged.truth),
    }
