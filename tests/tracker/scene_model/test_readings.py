"""Depth images made ready."""

from __future__ import annotations

import numpy as np
import pytest

from peopleboy.tracker.scene_model.readings import Readings


def test_the_noise_of_inverse_depth_is_found_from_images_alone(rng: np.random.Generator) -> None:
    inverse = 1.0 / np.linspace(2.0, 5.0, 160)[None, :].repeat(120, axis=0)
    before = None
    for _ in range(20):
        depth = 1.0 / (inverse + 0.002 * rng.standard_normal(inverse.shape))
        before = Readings.of(np.rint(1000.0 * depth).astype(np.uint16), before, 0.9)
    assert before is not None
    assert float(np.median(before.noise)) == pytest.approx(0.002, rel=0.25)


def test_pixels_between_two_surfaces_are_mixed_and_surfaces_are_not() -> None:
    depth = np.full((40, 60), 3000, np.uint16)
    depth[:, 30:] = 5000
    depth[:, 30] = 4000
    mixed = Readings.of(depth, None, 0.9).is_mixed
    assert mixed[1:-1, 30].all()
    assert not np.delete(mixed, 30, axis=1).any()
