"""What the panoramic tracker believes beyond its tracks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.panoramic.people.figure_patch import Map


@dataclass(frozen=True, slots=True, eq=False)
class PeopleExplanation:
    """What the tracker sees in its newest image.

    Attributes:
        background: (H, W, 3) uint8 RGB, what it takes for the scene without people.
        foreground: (H, W) how surely each pixel is on a person.
        covered: (H, W) 1 where it is on a person who is tracked.
    """

    background: NDArray[np.uint8]
    foreground: Map
    covered: Map
