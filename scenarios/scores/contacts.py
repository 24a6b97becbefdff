"""Contacts of the robot, as all scores count them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.truth.events import CONTACT_ENDS_S


def count_contacts(time_s: NDArray[np.float64], is_contact: NDArray[np.bool_]) -> int:
    """Count the contacts that begin in a run; who bounces, or rubs along a wall, touches it once.

    Args:
        time_s: (T,) of the frames.
        is_contact: (T,) whether the robot touched anything or anyone at each of them.
    """
    touches = np.flatnonzero(is_contact)
    is_apart = time_s[touches[1:] - 1] - time_s[touches[:-1]] >= CONTACT_ENDS_S
    return min(len(touches), 1) + int(is_apart.sum())


def count_starts(flags: NDArray[np.bool_]) -> int:
    """Count the runs of true values (T,)."""
    return int(np.sum(flags & ~np.concatenate([[False], flags[:-1]])))
