"""What a tracker gives out: people, each with an id, a contour and a box."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Status(StrEnum):
    """How well a person is seen right now."""

    TENTATIVE = "tentative"
    TRACKED = "tracked"
    PARTLY_OCCLUDED = "partly occluded"
    TOTALLY_OCCLUDED = "totally occluded"


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """One person as the tracker believes it at one instant.

    Attributes:
        id: 1 or more; a person who was forgotten and is found again gets a new one.
        ellipse: the estimated contour.
        box: left, top, width, height [px], which may reach outside the image.
        confidence: 0..1, how well the contour fits the image.
        status: whether the person is confirmed, and how much of it is hidden.
        age_s: time since the track was born [s].
        uncertainty_px2: spread of the particles about the estimate, over x and y [px^2] (thesis, equation
            4.6).
        occluder: id of the person in front who hides it; None if nobody does, or nobody known.
    """

    id: int
    ellipse: Ellipse
    box: tuple[float, float, float, float]
    confidence: float
    status: Status
    age_s: float
    uncertainty_px2: float
    occluder: int | None = None
