"""The detector: a filter over the whole image that looks for one more person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import TrackerConfig
from peopleboy.tracker.thermal.particle_filter import Belief, FrameView, advance, draw_fresh, weigh
from peopleboy.tracker.thermal.whereabouts import detector_factor, least_overlaps, regions_of


def detected(
    before: Belief | None,
    tracked: Sequence[NDArray[np.float64]],
    view: FrameView,
    config: TrackerConfig,
    rng: np.random.Generator,
) -> Belief:
    """Carry the detector on to this frame, in as many looks at the image as the settings ask for.

    Args:
        before: what it believed in the last frame; None if it starts.
        tracked: (9,) states of the people who are tracked and seen, off whom it is kept.
        view: this frame.
        config: of the tracker.
        rng: source of chance.
    """
    regions = regions_of(tracked, config)
    belief, moved = before, view
    for _ in range(config.search.looks):
        if belief is None:
            state = draw_fresh(config.detector.count, view, config.detector, config, rng)
        else:
            state = advance(belief.particles, moved, config.detector, config, rng)
        factor = detector_factor(least_overlaps(state, regions, config), config.interaction)
        belief = weigh(state, view, config.detector, config, factor)
        moved = replace(view, turn_rad=0.0)  # the camera has turned once
    assert belief is not None
    return belief
