"""When a person is born, and when given up."""

from __future__ import annotations

from peopleboy.tracker.thermal.config import LifeConfig
from peopleboy.tracker.thermal.particle_filter import Belief, FrameView


def is_born(belief: Belief, view: FrameView, config: LifeConfig) -> bool:
    """Tell whether a detector has settled on a person: it fits the image, and the samples agree.

    Source: thesis, section 4.2: mean of equation 4.4 above 0.5 and equation 4.6 below its threshold.
    """
    return belief.confidence > config.birth_confidence and _agrees(belief, view, config)


def is_kept(belief: Belief, view: FrameView, config: LifeConfig) -> bool:
    """Tell whether a tracked person is still seen.

    Source: thesis, section 5.1: a filter is deleted when its mean is smaller than 0.5 or its uncertainty too
    large.
    """
    return belief.confidence >= config.death_confidence and _agrees(belief, view, config)


def _agrees(belief: Belief, view: FrameView, config: LifeConfig) -> bool:
    """Compare the spread with its threshold, an area, which grows with the square of the image's size."""
    return belief.uncertainty_px2 < config.uncertainty_px2 * view.size**2
