"""All trees of the detector, and their file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.networks.weights_archive import SHIPPED, ArraySpec, WeightsArchive
from peopleboy.tracker.sensors.thermal.detector.box_regression import OFFSETS, BoxRegression
from peopleboy.tracker.sensors.thermal.detector.cascade import Cascade
from peopleboy.tracker.sensors.thermal.detector.channels import CHANNELS
from peopleboy.tracker.sensors.thermal.detector.patches import Patches
from peopleboy.tracker.sensors.thermal.detector.vector_trees import LEAVES, NODES
from peopleboy.tracker.sensors.thermal.detector.window import COLUMNS, ROWS, WindowKind

MODEL: Final = "cascade"
FILE: Final = "cascade.npz"

_PATCHES: Final = {
    "channel": ArraySpec(("patches",), np.uint8),
    "first": ArraySpec(("patches", 4), np.uint8),
    "second": ArraySpec(("patches", 4), np.uint8),
}
_TABLES: Final = ("feature", "threshold", "leaf")


class PeopleTrees(NamedTuple):
    """The trees for windows of one kind.

    Attributes:
        cascade: scores windows.
        regression: predicts the person's box in a window.
    """

    cascade: Cascade
    regression: BoxRegression


@dataclass(frozen=True, slots=True, eq=False)
class PeopleModel:
    """The trees for all kinds of windows, with common patches.

    Attributes:
        trees: by kind of window.
        about: description of the training data, for readers of the file.
    """

    trees: Mapping[WindowKind, PeopleTrees]
    about: Mapping[str, str] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write the trees."""
        patches = self.trees[WindowKind.WHOLE].cascade.patches
        arrays: dict[str, NDArray[Any]] = {name: getattr(patches, name) for name in _PATCHES}
        for kind, both in self.trees.items():
            arrays[f"{kind}_least"] = both.cascade.least
            for trees, prefix in ((both.cascade, kind), (both.regression, f"{kind}_placing")):
                arrays |= {f"{prefix}_{name}": getattr(trees, name) for name in _TABLES}
                arrays[f"{prefix}_feature"] = trees.feature.astype(np.int16)
        WeightsArchive(arrays, self.about).save(path)

    @classmethod
    def load(cls, path: Path) -> "PeopleModel":
        """Read trees.

        Raises:
            BadInput: the file is missing, invalid, or holds other trees.
        """
        specs = _PATCHES | {name: spec for kind in WindowKind for name, spec in _tree_specs(kind).items()}
        archive = WeightsArchive.load(path, MODEL, specs)
        patches = Patches(*(archive.arrays[name] for name in _PATCHES))
        features = [array for name, array in archive.arrays.items() if name.endswith("_feature")]
        is_fit = all(((one >= 0) & (one < len(patches))).all() for one in features)
        if not (_lie_in_the_window(patches) and is_fit):
            raise BadInput(
                f"holds no trees on patches of a window of {ROWS} x {COLUMNS} cells; "
                f"`peopleboy train {MODEL}` makes some",
                file=str(path),
            )
        return cls({kind: _trees(archive.arrays, kind, patches) for kind in WindowKind}, archive.about)


def _tree_specs(kind: WindowKind) -> dict[str, ArraySpec]:
    specs = {f"{kind}_least": ArraySpec((f"trees, {kind}",), may_be_infinite=True)}
    for prefix, trees in ((f"{kind}", (f"trees, {kind}",)), (f"{kind}_placing", (OFFSETS, f"more, {kind}"))):
        specs[f"{prefix}_feature"] = ArraySpec((*trees, NODES), np.int16)
        specs[f"{prefix}_threshold"] = ArraySpec((*trees, NODES), may_be_infinite=True)
        specs[f"{prefix}_leaf"] = ArraySpec((*trees, LEAVES))
    return specs


def _trees(arrays: Mapping[str, NDArray[Any]], kind: WindowKind, patches: Patches) -> PeopleTrees:
    scores, places = (
        [arrays[f"{prefix}_{name}"] for name in _TABLES] for prefix in (kind, f"{kind}_placing")
    )
    return PeopleTrees(
        Cascade(patches, scores[0].astype(np.int32), scores[1], scores[2], arrays[f"{kind}_least"]),
        BoxRegression(patches, places[0].astype(np.int32), places[1], places[2]),
    )


def _lie_in_the_window(patches: Patches) -> bool:
    boxes = np.stack([patches.first, patches.second])
    return (
        bool((patches.channel < CHANNELS).all())
        and bool((boxes[..., :2] <= boxes[..., 2:]).all())
        and bool((boxes[..., 2:] <= (ROWS, COLUMNS)).all())
    )


@cache
def shipped_people_trees() -> PeopleModel:
    """Read the shipped trees."""
    return PeopleModel.load(SHIPPED / FILE)
