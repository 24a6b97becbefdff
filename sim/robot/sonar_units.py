"""Where the sonars sit on the robot, and which way they point."""

import numpy as np

# x, y [m] and angle [deg] of each sonar of the lower rings: ARIA's parameter file peoplebot-sh.p, SonarUnit
# 0..15 (its 16..31, up on the deck, are left out).
_UNITS = np.array(
    [
        (0.069, 0.136, 90.0),
        (0.114, 0.119, 50.0),
        (0.148, 0.078, 30.0),
        (0.166, 0.027, 10.0),
        (0.166, -0.027, -10.0),
        (0.148, -0.078, -30.0),
        (0.114, -0.119, -50.0),
        (0.069, -0.136, -90.0),
        (-0.157, -0.136, -90.0),
        (-0.203, -0.119, -130.0),
        (-0.237, -0.078, -150.0),
        (-0.255, -0.027, -170.0),
        (-0.255, 0.027, 170.0),
        (-0.237, 0.078, 150.0),
        (-0.203, 0.119, 130.0),
        (-0.157, 0.136, 90.0),
    ]
)
SONAR_POSITION_M = _UNITS[:, :2].copy()
SONAR_ANGLE_RAD = np.radians(_UNITS[:, 2])
