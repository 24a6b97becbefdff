"""A person's contour in numbers."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Ellipse:
    """One person's contour in the thermal image: a body ellipse with a head ellipse on top.

    Image frame: x right, y down, origin at the centre of the top-left pixel.

    Attributes:
        x, y: centre of the body ellipse [px].
        w, h: its semi-axes [px]; the head's semi-height is h/4.4, and it stands on top of the body.
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
