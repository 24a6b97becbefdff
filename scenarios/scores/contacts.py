"""Contacts of the robot, as all scores count them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def count_contacts(is_contact: NDArray[np.bool_]) -> int:
    """Count the contacts that begin in a run.

    Args:
        is_contact: (T,) whether the robot touched anything or anyone at each frame.
    """
    return count_starts(is_contact)


def count_starts(flags: NDArray[np.bool_]) -> int:
    """Count the runs of true values (T,)."""
    return int(np.sum(flags & ~np.concatenate([[False], flags[:-1]])))
