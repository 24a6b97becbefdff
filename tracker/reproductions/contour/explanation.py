"""Explanations of the contour tracker: contours and particles behind its tracks."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.contour_config import TrackerConfig
from peopleboy.tracker.reproductions.contour.particles import VH, VW, VX, VY, D, H, Particles, W, X, Y


@dataclass(frozen=True, slots=True, kw_only=True)
class Ellipse:
    """One person's contour in the thermal image: a body ellipse with a head ellipse on top.

    Image frame: x right, y down, origin at the centre of the top-left pixel.

    Attributes:
        x, y: centre of the body ellipse [px].
        w, h: its semi-axes [px]; the head's semi-height is h/4.4, our reading, and it stands on top of it.
        d: offset of the head's centre to the right of the body's [px].
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
    """Make it from one (9,) state."""
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


# Explanation of the contour tracker.

DETECTOR_KEY = 0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContourExplanation:
    """State of the contour tracker at one instant, for plots and analysis.

    Attributes:
        config: settings of the tracker, which define contours.
        ellipses: the estimated contour by track id.
        spread_px2: spread of the particles about the estimate, over x and y [px^2], by track id.
        particles: the samples by track id; key 0 is the detector's cloud. Empty where they were not
                stored.
    """

    config: TrackerConfig
    ellipses: Mapping[int, Ellipse]
    spread_px2: Mapping[int, float]
    particles: Mapping[int, Particles] = field(default_factory=dict)

    def renumbered(self, number: Mapping[int, int]) -> "ContourExplanation":
        """Return it with replaced track ids; tracks without a new one are left out."""
        return replace(
            self,
            ellipses={number[one]: found for one, found in self.ellipses.items() if one in number},
            spread_px2={number[one]: found for one, found in self.spread_px2.items() if one in number},
            particles={
                number.get(one, DETECTOR_KEY): found
                for one, found in self.particles.items()
                if one in number or one == DETECTOR_KEY
            },
        )
