"""The sequences of the thesis's chapter 3, and the scenarios that stand for them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

SEQUENCES: Final[Mapping[str, str]] = {
    **{f"s1r{k}": f"bears_{k}" for k in range(1, 7)},
    **{f"s2r{k}": f"chairs_{k}" for k in (1, 2)},
    **{f"s3r{k}": f"tidying_{k}" for k in (1, 2)},
    **{f"s4r{k}": f"doors_{k}" for k in range(1, 5)},
    **{f"s5r{k}": f"cans_{k}" for k in (1, 2)},
    "s6r1": "plants_1",
}
"""Scenarios by the name of the sequence: bears rearranged, chairs moved, tidying up, doors, cans, plants."""

CHAIRS: Final = ("s2r1", "s2r2")
"""Sequences whose thin legs no sensor of these sees well."""

PRESETS: Final = ("tof", "kinect", "kinect_rough")
"""Depth cameras that watch them."""
