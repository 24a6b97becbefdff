"""Who hides whom, as arrows from front to back: as it is, and as the tracker believes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from peopleboy.scenarios.drawing.palette import TRUTH, Rgb, track_colour
from peopleboy.scenarios.recording.marks import Colours, Floats, colours_of
from peopleboy.sim.truth.truth import Box, PersonTruth
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Track

LEAST_SHARE = 0.02  # of a silhouette, from which being hidden is worth an arrow
_CHEST, _HEAD = 0.3, 0.08  # where arrows on images start and end, in box heights below the top
_HEIGHT_M = 1.3  # where arrows in the world are


@dataclass(frozen=True, slots=True, eq=False)
class Arrows:
    """K arrows with a colour and a label each.

    Attributes:
        start: (K, 2) [px] or (K, 3) [m].
        vector: (K, 2) or (K, 3) from there to the tip.
        colour: (K, 3).
        label: K texts.
    """

    start: Floats
    vector: Floats
    colour: Colours
    label: list[str]


def true_arrows(people: Sequence[PersonTruth]) -> Arrows:
    """Draw on the thermal image which person hides which share of whom."""
    pairs = [
        (_point(front.box, _CHEST), _point(behind.box, _HEAD), TRUTH, f"{share:.0%}")
        for front, behind, share in _hiding(people)
        if front.box is not None and behind.box is not None
    ]
    return _arrows(pairs, 2)


def world_arrows(people: Sequence[PersonTruth]) -> Arrows:
    """Draw the same in the world."""
    pairs = [
        ((*front.position_m, _HEIGHT_M), (*behind.position_m, _HEIGHT_M), TRUTH, f"{share:.0%}")
        for front, behind, share in _hiding(people)
    ]
    return _arrows(pairs, 3)


def believed_arrows(tracks: Iterable[Track]) -> Arrows:
    """Draw on the thermal image whom the tracker takes to be in front of whom, in the front one's colour."""
    known = {track.id: (track, track.boxes[THERMAL]) for track in tracks if THERMAL in track.boxes}
    pairs = [
        (_point(known[front][1], _CHEST), _point(box, _HEAD), track_colour(front), str(behind.status))
        for behind, box in known.values()
        if (front := behind.occluder) is not None and front in known
    ]
    return _arrows(pairs, 2)


def _hiding(people: Sequence[PersonTruth]) -> Iterator[tuple[PersonTruth, PersonTruth, float]]:
    """Yield who is in front, who is behind, and the share that is hidden."""
    known = {person.name: person for person in people}
    for behind in people:
        for name, share in behind.hidden_by.items():
            if name in known and share >= LEAST_SHARE:
                yield known[name], behind, share


def _point(box: Box, down: float) -> tuple[float, float]:
    left, top, width, height = box
    return left + width / 2.0, top + down * height


_Pair = tuple[tuple[float, ...], tuple[float, ...], Rgb, str]


def _arrows(pairs: Sequence[_Pair], size: int) -> Arrows:
    start = np.array([pair[0] for pair in pairs], np.float32).reshape(-1, size)
    tip = np.array([pair[1] for pair in pairs], np.float32).reshape(-1, size)
    return Arrows(start, tip - start, colours_of(pair[2] for pair in pairs), [pair[3] for pair in pairs])
