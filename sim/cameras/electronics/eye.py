"""What people are shown of a thermal camera: all of the room, whatever the camera's own gain leaves of it."""

from __future__ import annotations

from typing import Final

from peopleboy.sim.cameras.electronics.gain import (
    Grey,
    Temperatures,
    apply,
    equalised,
    grey_curve,
    histogram,
    span_of,
)

_TAIL: Final = 0.002
_PLATEAU: Final = 0.004
_LINEAR_SHARE: Final = 0.5
_LEAST_K: Final = 5.0


def show_scene(temperature_c: Temperatures) -> Grey:
    """Give an (H, W) image [degC] greys by itself, without memory of others; none is clipped."""
    shares = histogram(temperature_c)
    rise = equalised(shares, *span_of(shares, _TAIL), _PLATEAU, _LINEAR_SHARE, _LEAST_K)
    return apply(temperature_c, grey_curve(rise))
