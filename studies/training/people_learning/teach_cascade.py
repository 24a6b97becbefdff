"""Teaching boosted trees, and setting when a window is let go."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.people_learning.boosting import Binned, Boosting
from peopleboy.tracker.proposals.cascade import Cascade
from peopleboy.tracker.proposals.patches import Patches, Sums, summed_windows

_WEAKEST: Final = 0.03  # of people, whom no tree needs to keep
_LET_GO: Final = 0.005  # of all others may be let go
_STRICTER: Final = np.float32(0.7)  # than that, as most who are let go by it are hardly sure in the end
_AFTER: Final = np.float32(32.0)  # trees: the first ones tell people from others by less
_LOOKED_AT: Final = 20000  # people by whom that is told
_LAST: Final = -4.0
"""Score below which nothing is told."""


def teach_cascade(
    people: NDArray[np.float16], others: NDArray[np.float16], patches: Patches, boosting: Boosting
) -> Cascade:
    """Teach trees on windows (N, 1800) with people and without; both together weigh the same.

    Args:
        people: windows that people fill.
        others: such as show nobody.
        patches: what trees may ask for.
        boosting: how much is learned.

    Raises:
        BadInput: there are too few windows.
    """
    if min(len(people), len(others)) < boosting.smallest:
        raise BadInput(f"{len(people)} windows with people and {len(others)} without; take more worlds")
    sums = summed_windows(np.concatenate([people, others]))
    count = sums.shape[1]
    is_person = np.arange(count) < len(people)
    weight = np.where(is_person, 1.0 / len(people), 1.0 / len(others)).astype(np.float32)
    weight *= np.float32(count / 2)
    one = np.float32(1.0)

    def loss(told: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        share = one / (one + np.exp(-told))
        return weight * (is_person - share), weight * share * (one - share)

    rng = np.random.default_rng(0)
    tables = Binned(patches, sums, rng).boosted(loss, boosting, rng)
    some = np.sort(rng.permutation(len(people))[:_LOOKED_AT])
    return _letting_go(Cascade(patches, *tables, np.full(boosting.trees, -np.inf, np.float32)), sums[:, some])


def _letting_go(cascade: Cascade, people: Sums) -> Cascade:
    """Set after each tree what nearly all people have, who end up well."""
    running = cascade.running(people)
    is_found = running[:, -1] > np.quantile(running[:, -1], _WEAKEST)
    least = np.quantile(running[is_found], _LET_GO, axis=0).astype(np.float32)
    least += _STRICTER * np.minimum(np.arange(len(least), dtype=np.float32) / _AFTER, 1.0)
    least[-1] = _LAST
    return Cascade(cascade.patches, cascade.feature, cascade.threshold, cascade.leaf, least)
