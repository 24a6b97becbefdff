"""What a person would rather do now than what its script says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Wish:
    """What changes a person's script at an instant; the defaults change nothing.

    Attributes:
        goes_to: (2,) [m] where it goes in place of its way, giving way to all; None to keep to its way.
        stands: whether it stops where it is; its pauses stand still meanwhile.
        faces: (2,) [m] to what its body turns when it stands, and over the last steps to `goes_to`.
        looks_at: (2,) [m] to what its head turns; None for straight ahead.
        pace: share of the planned speed.
        clear_m: [m] how far its middle keeps away from the robot's; None for what is usual.
        heeds_robot: whether it makes way for the robot where it makes way at all.
        calls: whether it raises an arm and waves.
    """

    goes_to: Array | None = None
    stands: bool = False
    faces: Array | None = None
    looks_at: Array | None = None
    pace: float = 1.0
    clear_m: float | None = None
    heeds_robot: bool = True
    calls: bool = False


AS_PLANNED: Final = Wish()
