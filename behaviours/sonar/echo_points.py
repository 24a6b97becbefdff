"""Where the sonars' echoes lie around the robot."""

from __future__ import annotations

import math

import numpy as np

from peopleboy.behaviours.percept import Percept, Points

# The PeopleBot's ring: an ellipse within 3 cm of ARIA's peoplebot-sh.p, SonarUnit 0..15, except the four
# units that look sideways, which sit 11 cm fore and aft of it.
RING_CENTRE_X_M = -0.044
RING_HALF_AXES_M = (0.21, 0.14)
BESIDE_RAD = math.radians(7.5)  # half a beam's opening


def echoes(percept: Percept, spread_rad: float = 0.0) -> Points:
    """Place each sonar's echo in its beam: (N, 2) [m], x forward, y left, origin between the wheels.

    A range that is no number, or negative, counts as an obstacle at the sonar itself.

    Args:
        percept: with the sonars' ranges.
        spread_rad: [rad] how far off the beam's axis, towards the robot's side: BESIDE_RAD places a wall
            beside the way, whose echo comes from the edge of the beam.
    """
    ranges = np.where(np.isfinite(percept.sonar_m), np.maximum(percept.sonar_m, 0.0), 0.0)
    angle = percept.sonar_angle_rad + spread_rad * np.sign(np.round(np.sin(2.0 * percept.sonar_angle_rad), 6))
    axes = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points: Points = axes * (np.array(RING_HALF_AXES_M) + ranges[:, None])
    points[:, 0] += RING_CENTRE_X_M
    return points


def fill_drop_outs(ranges: list[Points]) -> Points:
    """Take each sonar's nearest range of the last few readings: (N,) [m].

    A lost echo reads as free space, so the nearest of a few readings is the one to trust. No number stays
    no number.

    Args:
        ranges: (N,) [m] each, newest last, at least one; those of another length are left out.
    """
    nearest: Points = np.min([r for r in ranges if r.shape == ranges[-1].shape], axis=0)
    return nearest
