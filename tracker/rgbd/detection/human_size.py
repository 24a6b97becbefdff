"""Whether something has the size of a human."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class HumanSize:
    """Size of a human as a camera sees it, and how much it may differ (SA eq. 4.12 to 4.15).

    A camera sees the front of a body only, which is less than the body is deep.

    Attributes:
        width_m, height_m, depth_m: [m] expected.
        width_sd_m, height_sd_m, depth_sd_m: [m] by which they may be off.
        is_cut: whether the height is expected as far as it can be in the image.
        least: probability of who is taken for a human.
    """

    width_m: float = 0.45
    height_m: float = 1.65
    depth_m: float = 0.35
    width_sd_m: float = 0.2
    height_sd_m: float = 0.35
    depth_sd_m: float = 0.25
    is_cut: bool = True
    least: float = 0.1

    def probability(self, width_m: float, height_m: float, depth_m: float, visible_m: float) -> float:
        """Rate a size, 1 for the expected one.

        Args:
            width_m: of what is there.
            height_m: likewise.
            depth_m: likewise.
            visible_m: [m] of the expected height that can be in the image.
        """
        expected = visible_m if self.is_cut else self.height_m
        squares = (
            ((width_m - self.width_m) / self.width_sd_m) ** 2
            + ((height_m - expected) / self.height_sd_m) ** 2
            + ((depth_m - self.depth_m) / self.depth_sd_m) ** 2
        )
        return math.exp(-0.5 * squares)


PRINTED_SIZE = HumanSize(
    width_m=0.7, height_m=1.65, depth_m=0.7, width_sd_m=0.35, height_sd_m=0.5, depth_sd_m=0.5, is_cut=False
)
"""SA 4.4.1; its standard deviations are not printed: narrower ones find hardly anybody."""
