"""Teaching the trees that tell where in a window somebody is."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.people_learning.boosting import Binned, Boosting
from peopleboy.tracker.proposals.patches import Patches, summed_windows
from peopleboy.tracker.proposals.placing import Placing

_BOOSTING: Final = Boosting(trees=160, rate=0.1, features=300)
_FAR: Final = (
    0.9  # of all windows are nearer to the median; how far off the others are does not count (Huber)
)


def teach_placing(windows: NDArray[np.float16], offsets: NDArray[np.float64], patches: Patches) -> Placing:
    """Teach trees on windows (N, 1800) whose offsets (N, 4) are known, and on patches of them."""
    rng = np.random.default_rng(0)
    binned, tables = Binned(patches, summed_windows(windows), rng), []
    for target in offsets.T.astype(np.float32):
        start = float(np.median(target))
        far = float(np.quantile(np.abs(target - start), _FAR))

        def loss(
            told: NDArray[np.float32], target: NDArray[np.float32] = target, far: float = far
        ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
            return np.clip(target - told, -far, far), np.ones_like(told)

        trees = binned.boosted(loss, _BOOSTING, rng, start)
        trees.leaf[0] += np.float32(start)
        tables.append(trees)
    return Placing(patches, *(np.stack(column) for column in zip(*tables, strict=True)))
