"""Examples for the second look: what trees propose in varied images, and whom it shows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.studies.people_learning.cut_off import cut_off
from peopleboy.scenarios.studies.people_learning.many_threads import in_threads
from peopleboy.scenarios.studies.people_learning.shots import PeopleShot
from peopleboy.scenarios.studies.second_look.electronics import through_electronics
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.proposals.crops import NUMBERS, Crops, Planes, crops_of, numbers_of
from peopleboy.tracker.proposals.detector import SMALLEST_PX, WEAKEST, look
from peopleboy.tracker.proposals.model import PeopleModel
from peopleboy.tracker.proposals.placing import OFFSETS, offsets
from peopleboy.tracker.proposals.suppression import Proposals
from peopleboy.tracker.proposals.window import Floats

SOMEBODY: Final = 0.35
"""IoU from which on a proposal is somebody."""
NOBODY: Final = 0.2
"""IoU up to which it is nobody; what is between is neither."""

_VARIETIES: Final = 2  # of each image
_AS_IT_IS: Final = 0.25  # of them
_CUT: Final = 0.25  # end in the middle of somebody
_MOUNT_KNOWN: Final = 0.6  # of images
_JITTERED: Final = 0.5  # of proposals are learned a second time, elsewhere
_ASIDE: Final = (0.04, 0.05)  # deviations of where, in heights to the right and down
_GROWN: Final = 0.09  # of the logarithm of the size
_SURER: Final = 0.5  # of the score


class LookExamples(NamedTuple):
    """What is learned from.

    Attributes:
        crops: (N, 64, 48, 3) uint8.
        numbers: (N, 9), see `crops.numbers_of`.
        overlap: (N,) IoU with somebody who is seen, at most.
        offsets: (N, 4) of them, see `placing.offsets`; 0 if there is nobody.
    """

    crops: Crops
    numbers: Planes
    overlap: NDArray[np.float32]
    offsets: Planes

    @classmethod
    def joined(cls, parts: Iterable[LookExamples]) -> LookExamples:
        """Take examples together."""
        none = cls(
            np.empty((0, *_NO_CROP.shape), np.uint8),
            np.empty((0, NUMBERS), np.float32),
            np.empty(0, np.float32),
            np.empty((0, OFFSETS), np.float32),
        )
        return cls(*(np.concatenate(column) for column in zip(none, *parts, strict=True)))

    def take(self, rows: NDArray[np.intp]) -> LookExamples:
        """Give some of them."""
        return LookExamples(self.crops[rows], self.numbers[rows], self.overlap[rows], self.offsets[rows])

    def mirrored(self) -> LookExamples:
        """Swap left and right."""
        numbers, offset = self.numbers.copy(), self.offsets.copy()
        numbers[:, 4:6] = self.numbers[:, [5, 4]]
        offset[:, 0] *= -1.0
        return LookExamples(self.crops[:, :, ::-1], numbers, self.overlap, offset)


_NO_CROP: Final = crops_of(np.zeros((1, 1), np.uint8), np.zeros((1, 1), np.uint8), np.ones((1, 4)))[0]


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
    drawn = _varied(shots, rng) if varies else ((shot, shot.mount is not None, None) for shot in shots)
    return LookExamples.joined(in_threads(lambda one: _looks(*one, model), drawn))


def _varied(
    shots: Sequence[PeopleShot], rng: np.random.Generator
) -> Iterator[tuple[PeopleShot, bool, np.random.Generator]]:
    for shot in shots:
        for _ in range(_VARIETIES):
            own = np.random.default_rng(rng.integers(2**63))
            varied = shot if own.random() < _AS_IT_IS else through_electronics(shot.varied(own), own)
            yield cut_off(varied, own) if own.random() < _CUT else varied, own.random() < _MOUNT_KNOWN, own


def _looks(
    shot: PeopleShot, is_known: bool, rng: np.random.Generator | None, model: PeopleModel
) -> LookExamples:
    mount = shot.mount if is_known else None
    found = look(model, shot.grey, shot.change, mount, SMALLEST_PX, WEAKEST)
    if rng is not None:
        found = _jittered(found, rng)
    crops = crops_of(shot.grey, shot.change, found.box)
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
    return Proposals(np.concatenate([found.box, box]), np.concatenate([found.score, score]))


def _whom(box: Floats, people: Floats) -> tuple[Floats, Floats]:
    """Tell how much boxes (N, 4) overlap one of people (P, 4), at most, and that one's offsets (N, 4)."""
    overlap, offset = np.zeros(len(box)), np.zeros((len(box), OFFSETS))
    if len(people) and len(box):
        shared = iou(box[:, None], people[None])
        overlap = shared.max(axis=1)
        is_some = overlap > 0.0
        offset[is_some] = offsets(box[is_some], people[shared.argmax(axis=1)[is_some]])
    return overlap, offset
