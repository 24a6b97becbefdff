"""Examples for the closer look: people in varied images, and boxes that are about theirs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.studies.training.look_learning.varied_shots import LookedAt, as_they_are, varied_shots
from peopleboy.studies.training.people_learning.shots import PeopleShot
from peopleboy.tracker.boxes import area, cover, intersection, iou
from peopleboy.tracker.proposals.looks.closer_look import CloserLook
from peopleboy.tracker.proposals.looks.crops import crops_of, numbers_of
from peopleboy.tracker.proposals.placing import offsets
from peopleboy.tracker.proposals.suppression import Proposals
from peopleboy.tracker.proposals.window import Floats

_VARIETIES: Final = 4  # of each image
_HARDLY_SEEN: Final = 0.3  # of those who are hidden or not upright are learned from
_INSIDE: Final = 0.25  # of a box, at least
_TALL_PX: Final = 16.0
# How far off the second look is: deviations of middle, head and feet in heights, of the width's logarithm.
_MIDDLE, _HEAD, _FEET, _WIDTH = 0.018, 0.03, 0.055, 0.1
_FAR_OFF: Final = 0.3  # of boxes
_FARTHER: Final = 2.2  # times as far
_LOWEST: Final = 0.4  # heights of whom it is about


def closer_looks_of(shots: Sequence[PeopleShot], rng: np.random.Generator, *, varies: bool) -> LookExamples:
    """Collect people in images, with boxes as far off as those of the second look.

    Args:
        shots: the images.
        rng: draws how images are varied, and how far boxes are off.
        varies: whether images are varied, as to learn from; else they stay as they are.
    """
    drawn = varied_shots(shots, rng, _VARIETIES) if varies else as_they_are(shots, rng)
    return LookExamples.joined(map(_looks, drawn), CloserLook.FORM.crop)


def _looks(one: LookedAt) -> LookExamples:
    shot, mount, rng = one
    shape = (shot.grey.shape[0], shot.grey.shape[1])
    people = shot.box[_is_learned_from(shot, rng)]
    boxes = _about(people, rng)
    crops = crops_of(shot.grey, shot.change, boxes, CloserLook.FORM.crop)
    numbers = numbers_of(Proposals.of_trees(boxes, np.zeros(len(boxes))), crops, shape, mount)
    overlap = iou(boxes, people).astype(np.float32)
    return LookExamples(crops, numbers, overlap, offsets(boxes, people).astype(np.float32))


def _is_learned_from(shot: PeopleShot, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Tell of whom (P,) enough is seen, and of some of the others that they are learned from, too."""
    rows, columns = shot.grey.shape
    image = np.array([0.0, 0.0, columns, rows])
    is_inside = cover(intersection(shot.box, image), area(shot.box)) > _INSIDE
    is_seen = shot.is_good | shot.is_clear | (rng.random(len(shot.box)) < _HARDLY_SEEN)
    return np.asarray(is_seen & is_inside & (shot.box[:, 3] > _TALL_PX), np.bool_)


def _about(people: Floats, rng: np.random.Generator) -> Floats:
    """Give a box about each of people (P, 4), off as the second look's are: some more, some less."""
    left, top, width, height = people.T
    far = np.where(rng.random(len(people)) < _FAR_OFF, _FARTHER, 1.0)
    aside, up, down, wider = (
        far * rng.normal(0.0, off, len(people)) for off in (_MIDDLE, _HEAD, _FEET, _WIDTH)
    )
    wide, tall = width * np.exp(wider), height * np.maximum(1.0 + down - up, _LOWEST)
    middle = left + width / 2.0 + height * aside
    return np.stack([middle - wide / 2.0, top + height * up, wide, tall], axis=1)
