"""A person's contour in numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.particles import VH, VW, VX, VY, D, H, W, X, Y


@dataclass(frozen=True, slots=True, kw_only=True)
class Ellipse:
    """One person's contour in the thermal image: a body ellipse with a head ellipse on top.

    Image frame: x right, y down, origin at the centre of the top-left pixel.

    Attributes:
        x, y: centre of the body ellipse [px].
        w, h: its semi-axes [px]; the head's semi-height is h/4.4, our reading, and it stands on top of it.
        d: how far the head's centre lies right of the body's [px].
        vx, vy, vw, vh: rates of change of x, y, w and h [px/s].

    Source: thesis, section 4.2.
    """

    x: float
    y: float
    w: float
    h: float
    d: float
    vx: float
    vy: float
    vw: float
    vh: float


def ellipse_of(state: NDArray[np.floating]) -> Ellipse:
    """Name the entries of one (9,) state."""
    return Ellipse(
        x=float(state[X]),
        y=float(state[Y]),
        w=float(state[W]),
        h=float(state[H]),
        d=float(state[D]),
        vx=float(state[VX]),
        vy=float(state[VY]),
        vw=float(state[VW]),
        vh=float(state[VH]),
    )
