"""All that an instant of a world is told as, images aside."""

from __future__ import annotations

from typing import NamedTuple

from peopleboy.sim.observation import Senses
from peopleboy.sim.truth.image_free_truth import ImageFreeTruth


class Instant(NamedTuple):
    """What a robot senses, and what is true at the same time."""

    senses: Senses
    scene: ImageFreeTruth
