"""What a behaviour asks of the robot: a forward speed and a turn rate."""

from __future__ import annotations

import math
from dataclasses import dataclass

from peopleboy.bad_input import BadInput


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """A velocity command in the robot's frame.

    Attributes:
        linear_m_s: [m/s] forward speed, negative drives backwards.
        angular_rad_s: [rad/s] turn rate, positive turns left.
        is_emergency: whether the robot is to lose its speeds as fast as it can.

    Raises:
        BadInput: a value is not finite.
    """

    linear_m_s: float
    angular_rad_s: float
    is_emergency: bool = False

    def __post_init__(self) -> None:
        """Refuse what no motor can do."""
        if not (math.isfinite(self.linear_m_s) and math.isfinite(self.angular_rad_s)):
            raise BadInput(
                f"command must be finite, got {self.linear_m_s} m/s and {self.angular_rad_s} rad/s"
            )


STOP = Command(linear_m_s=0.0, angular_rad_s=0.0)
EMERGENCY_STOP = Command(linear_m_s=0.0, angular_rad_s=0.0, is_emergency=True)
