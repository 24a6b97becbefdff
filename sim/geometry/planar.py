"""Poses on the floor."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Planar:
    """Where something stands on the floor: x, y [m] and heading [rad], world frame."""

    x: float
    y: float
    heading: float
