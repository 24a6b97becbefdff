"""Examples for the second look: what trees propose in varied images, and whom it shows."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Final

import numpy as np

from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.studies.training.look_learning.varied_shots import LookedAt, as_they_are, varied_shots
from peopleboy.studies.training.people_learning.many_threads import in_threads
from peopleboy.studies.training.people_learning.shots import PeopleShot
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.proposals.detector import SMALLEST_PX, WEAKEST, look
from peopleboy.tracker.proposals.looks.crops import crops_of, numbers_of
from peopleboy.tracker.proposals.looks.second_look import SecondLook
from peopleboy.tracker.proposals.model import PeopleModel
from peopleboy.tracker.proposals.placing import OFFSETS, offsets
from peopleboy.tracker.proposals.suppression import Proposals
from peopleboy.tracker.proposals.window import Floats

SOMEBODY: Final = 0.35
"""IoU from which on a proposal is somebody."""
NOBODY: Final = 0.2
"""IoU up to which it is nobody; what is between is neither."""

_VARIETIES: Final = 2  # of each image
_JITTERED: Final = 0.5  # of proposals are learned a second time, elsewhere
_ASIDE: Final = (0.04, 0.05)  # deviations of where, in heights to the right and down
_GROWN: Final = 0.09  # of the logarithm of the size
_SURER: Final = 0.5  # of the score


def looks_of(
    shots: Sequence[PeopleShot], model: PeopleModel, rng: np.random.Generator, *, varies: bool
) -> LookExamples:
    """Collect what trees propose in images.

    Args:
        shots: the images.
        model: trees.
        rng: draws how images are varied.
        varies: whether images are varied, and boxes also moved, as to learn from; else both stay as they are.
    """
    drawn = varied_shots(shots, rng, _VARIETIES) if varies else as_they_are(shots, rng)
    parts = in_threads(partial(_looks, model=model, varies=varies), drawn)
    return LookExamples.joined(parts, SecondLook.FORM.crop)


def _looks(one: LookedAt, *, model: PeopleModel, varies: bool) -> LookExamples:
    shot, mount, rng = one
    found = look(model, shot.grey, shot.change, mount, SMALLEST_PX, WEAKEST)
    if varies:
        found = _jittered(found, rng)
    crops = crops_of(shot.grey, shot.change, found.box, SecondLook.FORM.crop)
    overlap, offset = _whom(found.box, shot.box)
    numbers = numbers_of(found, crops, (shot.grey.shape[0], shot.grey.shape[1]), mount)
    return LookExamples(crops, numbers, overlap.astype(np.float32), offset.astype(np.float32))


def _jittered(found: Proposals, rng: np.random.Generator) -> Proposals:
    """Give proposals, and some of them again, a little elsewhere."""
    again = np.flatnonzero(rng.random(len(found.box)) < _JITTERED)
    left, top, width, height = found.box[again].T
    right, down = (height * rng.normal(0.0, deviation, len(again)) for deviation in _ASIDE)
    grown = np.exp(rng.normal(0.0, _GROWN, len(again)))
    wide, tall = grown * width, grown * height
    middle, centre = left + width / 2.0 + right, top + height / 2.0 + down
    box = np.stack([middle - wide / 2.0, centre - tall / 2.0, wide, tall], axis=1)
    score = found.score[again] + rng.normal(0.0, _SURER, len(again))
    return Proposals.of_trees(np.concatenate([found.box, box]), np.concatenate([found.score, score]))


def _whom(box: Floats, people: Floats) -> tuple[Floats, Floats]:
    """Tell how much boxes (N, 4) overlap one of people (P, 4), at most, and that one's offsets (N, 4)."""
    overlap, offset = np.zeros(len(box)), np.zeros((len(box), OFFSETS))
    if len(people) and len(box):
        shared = iou(box[:, None], people[None])
        overlap = shared.max(axis=1)
        is_some = overlap > 0.0
        offset[is_some] = offsets(box[is_some], people[shared.argmax(axis=1)[is_some]])
    return overlap, offset
