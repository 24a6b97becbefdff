"""Where the sonars sit on the robot."""

from __future__ import annotations

import numpy as np

from peopleboy.behaviours.percept import Points
from peopleboy.behaviours.sonar.echo_points import RING_CENTRE_X_M, RING_HALF_AXES_M

# The PeopleBot's sideways units sit this far fore and aft of the ellipse on which all others lie.
SIDEWAYS_M = 0.113


def mounts(angle_rad: Points) -> Points:
    """Give the sonars' places by their directions [rad]: (N, 2) [m], x forward, y left.

    Of two units that look the same way, which only those do that look sideways, the first sits fore.

    Source: ARIA's peoplebot-sh.p, SonarUnit 0..15, within 3 cm.
    """
    places: Points = np.stack([np.cos(angle_rad), np.sin(angle_rad)], axis=1) * RING_HALF_AXES_M
    places[:, 0] += RING_CENTRE_X_M
    is_same = np.abs(angle_rad[:, None] - angle_rad) < 1e-6
    has_later, has_earlier = np.triu(is_same, 1).any(axis=1), np.tril(is_same, -1).any(axis=1)
    places[:, 0] += SIDEWAYS_M * (has_later.astype(np.float64) - has_earlier)
    return places
