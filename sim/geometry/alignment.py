"""From pixels of one camera to pixels of the other, for things at one depth."""

from __future__ import annotations

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose, transform


def affine_between(thermal: Pinhole, colour: Pinhole, depth_m: float) -> Matrix:
    """Find the (2, 3) map of thermal pixels u, v, 1 to colour pixels, for things at a depth.

    The depth is that along the thermal camera's axis. The map is exact where the optical axes are parallel,
    as they are by default; where they are not, it is the best fit, in least squares, over the thermal image.

    Source: thesis, equation 6.1, which fixes the map by hand; here it follows from the cameras.

    Raises:
        BadInput: the depth is not positive, or the colour camera does not see the plane.
    """
    if not depth_m > 0.0:
        raise BadInput(f"depth {depth_m} m must be positive")
    columns, rows = np.linspace(0.0, thermal.width - 1.0, 9), np.linspace(0.0, thermal.height - 1.0, 9)
    u, v = (grid.ravel() for grid in np.meshgrid(columns, rows))
    pixels = np.stack([u, v, np.ones_like(u)], axis=1)
    points = depth_m * pixels @ np.linalg.inv(thermal.intrinsics).T
    colour_from_thermal = invert_pose(colour.robot_from_camera) @ thermal.robot_from_camera
    seen = colour.project(transform(colour_from_thermal, points))
    if not np.isfinite(seen).all():
        raise BadInput(f"the colour camera does not see the plane {depth_m} m before the thermal camera")
    return np.asarray(np.linalg.lstsq(pixels, seen)[0].T, np.float64)
