"""All trees of the detector, and their file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.proposals.cascade import DEPTH, LEAVES, NODES, Cascade
from peopleboy.tracker.proposals.channels import CHANNELS
from peopleboy.tracker.proposals.patches import Patches
from peopleboy.tracker.proposals.placing import OFFSETS, Placing
from peopleboy.tracker.proposals.window import COLUMNS, ROWS, Kind
from peopleboy.tracker.weights_archive import opened_archive

COMMAND: Final = "peopleboy train-detector"
WEIGHTS: Final = Path(__file__).parent / "weights" / "people.npz"
"""The trees that come with the tracker."""

_ABOUT: Final = "about"
_PATCHES: Final = ("channel", "first", "second")
_ARRAYS: Final = ("feature", "threshold", "leaf")
_PREFIXES: Final = ("", "placing_")
_KINDS: Final = tuple(np.dtype(kind) for kind in (np.int16, np.float32, np.float32))


class PeopleTrees(NamedTuple):
    """Of windows of a kind: which show people, and where.

    Attributes:
        cascade: tells whether somebody is in a window.
        placing: tells where in it.
    """

    cascade: Cascade
    placing: Placing


@dataclass(frozen=True, slots=True, eq=False)
class PeopleModel:
    """What people look like.

    Attributes:
        trees: for windows of a kind.
        about: what they were learned from, for the reader.
    """

    trees: Mapping[Kind, PeopleTrees]
    about: Mapping[str, str] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write a NumPy archive without pickles."""
        content: dict[str, Any] = {_ABOUT: np.array(json.dumps(dict(self.about)))}
        content |= {name: getattr(self.trees[Kind.WHOLE].cascade.patches, name) for name in _PATCHES}
        for kind, both in self.trees.items():
            content[f"{kind}_least"] = both.cascade.least
            for trees, prefix in ((both.cascade, ""), (both.placing, "placing_")):
                content |= {f"{kind}_{prefix}{name}": getattr(trees, name) for name in _ARRAYS}
                content[f"{kind}_{prefix}feature"] = trees.feature.astype(np.int16)
        with path.open("wb") as file:
            np.savez_compressed(file, **content)

    @classmethod
    def load(cls, path: Path) -> PeopleModel:
        """Read trees.

        Raises:
            BadInput: a file that is missing, is none, or holds other trees.
        """
        with opened_archive(path, COMMAND) as archive:
            about = json.loads(str(archive[_ABOUT]))
            patches = Patches(*(np.asarray(archive[name]) for name in _PATCHES))
            tables = {kind: _Tables.read(archive, kind) for kind in Kind}
        if not (_are_patches(patches) and all(one.fit(len(patches)) for one in tables.values())):
            raise BadInput(
                f"holds no trees of depth {DEPTH} on patches of a window of {ROWS} x {COLUMNS} cells; "
                f"`{COMMAND}` makes some",
                file=str(path),
            )
        return cls({kind: one.trees(patches) for kind, one in tables.items()}, about)


class _Tables(NamedTuple):
    """What a file holds of windows of a kind."""

    least: NDArray[Any]
    whether: list[NDArray[Any]]
    where: list[NDArray[Any]]

    @classmethod
    def read(cls, archive: Mapping[str, NDArray[Any]], kind: Kind) -> _Tables:
        whether, where = (
            [np.asarray(archive[f"{kind}_{prefix}{name}"]) for name in _ARRAYS] for prefix in _PREFIXES
        )
        return cls(np.asarray(archive[f"{kind}_least"]), whether, where)

    def fit(self, patches: int) -> bool:
        """Tell whether these are tables of trees on so many patches."""
        least, whether, where = self
        trees = len(least) if least.ndim == 1 else 0
        return (
            trees > 0
            and least.dtype == np.float32
            and not bool(np.isnan(least).any())
            and _are_trees(whether, (trees,), patches)
            and _are_trees(where, (OFFSETS, where[0].shape[1] if where[0].ndim == 3 else 0), patches)
        )

    def trees(self, patches: Patches) -> PeopleTrees:
        least, whether, where = self
        return PeopleTrees(
            Cascade(patches, whether[0].astype(np.int32), whether[1], whether[2], least),
            Placing(patches, where[0].astype(np.int32), where[1], where[2]),
        )


def _are_patches(patches: Patches) -> bool:
    """Tell whether all rectangles lie in a window."""
    boxes = np.stack([patches.first, patches.second]) if patches.first.shape == patches.second.shape else None
    return (
        boxes is not None
        and boxes.shape == (2, patches.channel.size, 4)
        and all(array.dtype == np.uint8 for array in (patches.channel, patches.first, patches.second))
        and bool((patches.channel < CHANNELS).all())
        and bool((boxes[..., :2] <= boxes[..., 2:]).all())
        and bool((boxes[..., 2:] <= (ROWS, COLUMNS)).all())
    )


def _are_trees(arrays: list[NDArray[Any]], trees: tuple[int, ...], patches: int) -> bool:
    """Tell whether features, thresholds and leaves are those of so many trees."""
    feature, threshold, leaf = arrays
    return (
        feature.shape == threshold.shape == (*trees, NODES)
        and leaf.shape == (*trees, LEAVES)
        and tuple(array.dtype for array in arrays) == _KINDS
        and bool(((feature >= 0) & (feature < patches)).all())
        and not bool(np.isnan(threshold).any())
        and bool(np.isfinite(leaf).all())
    )


@cache
def shipped_model() -> PeopleModel:
    """Read the trees that come with the tracker."""
    return PeopleModel.load(WEIGHTS)
