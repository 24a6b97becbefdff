"""Votes of beams for positions of people, and their groups."""

from typing import Final, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import ScanCalibration
from peopleboy.tracker.sensors.laser.scan_windows import Floats, Inputs

FEATURES: Final = 9
"""Features of a group of votes; see `group_votes`."""
APART_M: Final = 0.4
"""Votes nearer to each other are of one person."""


class Votes(NamedTuple):
    """Votes of V beams.

    Attributes:
        places_m: (V, 2) forward and left in the robot's frame.
        scores: (V,) log-odds.
        ranges_m: (V,) of the beams.
    """

    places_m: Floats
    scores: Floats
    ranges_m: Floats


class VoteGroups(NamedTuple):
    """Votes of each of M people.

    Attributes:
        places_m: (M, 2) forward and left in the robot's frame.
        features: (M, FEATURES).
    """

    places_m: Floats
    features: Inputs


def vote_places(
    beams: NDArray[np.int64], metres: Floats, offsets: Floats, calibration: ScanCalibration
) -> Floats:
    """Return positions (V, 2) in the robot's frame, at offsets (V, 2) from where beams of ranges (V,) end."""
    bearing = calibration.bearings[beams]
    ahead = np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
    left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
    reach = (metres + offsets[:, 0])[:, None] * ahead + offsets[:, 1:] * left
    return np.asarray(calibration.position_m[:2] + reach, np.float64)


def group_votes(votes: Votes, calibration: ScanCalibration) -> VoteGroups:
    """Group votes about the strongest ones, each with all others within `APART_M` that are still free.

    The features of a group are: greatest, mean and summed log-odds and probability of its votes, their
    spread [m], number, width of the beams [m], and range [10 m].
    """
    order = np.argsort(-votes.scores, kind="stable")
    places, features = np.empty((len(order), 2)), np.empty((len(order), FEATURES), np.float32)
    count = _group(
        votes.places_m[order], votes.scores[order], votes.ranges_m[order], calibration.step_rad, places,
        features,
    )  # fmt: skip
    return VoteGroups(places[:count], features[:count])


@njit(cache=True, nogil=True)
def _group(at: Floats, score: Floats, near: Floats, step_rad: float, places: Floats, features: Inputs) -> int:
    count, is_free = 0, np.ones(len(at), np.bool_)
    for first in range(len(at)):
        if not is_free[first]:
            continue
        total, x, y, squares, members, logs, shares = 0.0, 0.0, 0.0, 0.0, 0, 0.0, 0.0
        for k in range(first, len(at)):
            off = (at[k, 0] - at[first, 0]) ** 2 + (at[k, 1] - at[first, 1]) ** 2
            if not is_free[k] or off > APART_M**2:
                continue
            is_free[k] = False
            weight = 1.0 / (1.0 + np.exp(-score[k]))
            total += weight
            x += weight * at[k, 0]
            y += weight * at[k, 1]
            squares += weight * off
            members += 1
            logs += score[k]
            shares += weight * near[k]
        places[count, 0], places[count, 1] = x / total, y / total
        reach = shares / total
        features[count, 0] = score[first] / 4.0
        features[count, 1] = logs / members / 4.0
        features[count, 2] = total / members
        features[count, 3] = np.log(total)
        features[count, 4] = np.sqrt(squares / total) / APART_M
        features[count, 5] = np.log(members) / 4.0
        features[count, 6] = members * reach * step_rad
        features[count, 7] = total * reach * step_rad
        features[count, 8] = reach / 10.0
        count += 1
    return count
