"""Clips of a folder: pictures, and who is in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.mot_files import read_truth
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.footage.pictures import open_footage
from peopleboy.tracker.footage.truth_files import GivenTruth, find_truth, load_truth

CHOSEN_BY: Final = ("camel_08", "camel_21")
"""The clips by which values may be chosen; all others are only reported."""
TRUTH: Final = "gt.txt"


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """The first frames of a clip.

    Attributes:
        folder: of the clip; its pictures lie there or in an inner folder such as `thermal`.
        given: the truth of these frames.
        frames: how many there are.
    """

    folder: Path
    given: GivenTruth
    frames: int

    @property
    def name(self) -> str:
        """The folder's name."""
        return self.folder.name


def open_clips(home: Path, only: Sequence[str] = (), frames: int | None = None) -> list[Clip]:
    """Open the clips of a folder: those by which values are chosen, then the others, by name.

    Args:
        home: a folder of clips, each a folder of its own.
        only: names of clips; none for all.
        frames: how many of each to take, from the first on; None for all.

    Raises:
        BadInput: there are no clips, or one that is named is missing or cannot be used.
    """
    there = {one.name: one for one in home.iterdir() if find_truth(one) is not None}
    missing = [name for name in only if name not in there]
    if missing or not there:
        told = ", ".join(sorted(there)) or "none"
        raise BadInput(f"{home}: no clip {' '.join(missing)} with pictures and {TRUTH}; there are: {told}")
    names = sorted(only or there, key=lambda name: (name not in CHOSEN_BY, name))
    return [_open(there[name], frames) for name in names]


def _open(folder: Path, frames: int | None) -> Clip:
    path, there = find_truth(folder), open_footage(folder).expected
    assert path is not None
    count = there if frames is None else min(frames, there)
    given = _load(path, there)
    return Clip(folder, replace(given, truth=_first(given.truth, count)), count)


def _load(path: Path, frames: int) -> GivenTruth:
    """Read truth; what is no person, such as a bicycle, is neither to be found nor wrong to find."""
    if path.name == TRUTH:
        return GivenTruth(read_truth(path, keeps_things=True), is_single=False, path=path)
    return load_truth(path, frames)


def _first(truth: TrueBoxes, frames: int) -> TrueBoxes:
    return truth.take(truth.frame <= frames)
