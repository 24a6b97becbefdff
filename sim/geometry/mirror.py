"""The cone-shaped mirror of a panoramic camera: how high and how far off the axis it makes a camera see."""

from __future__ import annotations

import math
from dataclasses import dataclass

from peopleboy.bad_input import BadInput


@dataclass(frozen=True, slots=True, kw_only=True)
class Mirror:
    """A cone, apex down, over a camera that looks straight up.

    In each direction the mirror's line is straight, so it shows what a camera without a mirror would see from
    the lens's mirror image. These images form a ring, whose cameras look outwards and down by `axis_rad`; the
    ray that the lens sees at an angle t off its own axis leaves them t higher.

    Source: Baker and Nayar, A theory of single-viewpoint catadioptric image formation, IJCV 35, 175 (1999),
    section 3.1.1; their ring has another radius, which the law of reflection does not give.

    Attributes:
        half_apex_rad: [rad] between the cone's axis and its side.
        lens_half_angle_rad: [rad] between the lens's axis and its image's rim, where the view is highest.
        lens_m: [m] from the lens up to the apex.
        apex_m: [m] height of the apex above the floor.

    Raises:
        BadInput: the lens sees past the mirror, or the mirror shows no floor or something that is no number.
    """

    half_apex_rad: float = math.radians(72.5)
    lens_half_angle_rad: float = math.radians(47.0)
    lens_m: float = 0.04
    apex_m: float = 1.68

    def __post_init__(self) -> None:
        """Refuse a mirror that cannot be used."""
        apex, lens = math.degrees(self.half_apex_rad), math.degrees(self.lens_half_angle_rad)
        if not 45.0 < apex < 90.0:
            raise BadInput(f"half_apex_deg {apex:g}: shows no floor, or is no cone; must be 45 to 90")
        if not 0.0 < lens < apex:
            raise BadInput(
                f"lens_half_angle_deg {lens:g}: must be above 0, and below half_apex_deg, {apex:g}"
            )
        if not (self.lens_m > 0.0 and self.apex_m > self.lens_m and math.isfinite(self.apex_m)):
            raise BadInput(f"lens_m {self.lens_m:g}: must be above 0, and below apex_m, {self.apex_m:g}")

    @property
    def axis_rad(self) -> float:
        """[rad] below the horizon: the lowest view, which the lens sees in the middle of its image."""
        return 2.0 * self.half_apex_rad - math.pi / 2.0

    @property
    def ring_radius_m(self) -> float:
        """[m] distance of the ring's cameras from the axis in the direction of view; negative: behind it."""
        return -self.lens_m * math.sin(2.0 * self.half_apex_rad)

    @property
    def ring_height_m(self) -> float:
        """[m] height of the ring above the floor."""
        return self.apex_m - self.lens_m * math.cos(2.0 * self.half_apex_rad)


MIRRORS = {
    "default": Mirror(),
    "narrow": Mirror(
        half_apex_rad=math.radians(62.5), lens_half_angle_rad=math.radians(27.0), lens_m=0.08, apex_m=1.66
    ),
}
"""Mirrors by name: the usual one shows 55 to 8 degrees below the horizon, the narrow one 35 to 8."""
