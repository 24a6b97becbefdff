"""Neighbours on one plane know a pixel's depth, too."""

from __future__ import annotations

import numpy as np
import pytest

from peopleboy.tracker.scene_model.layers import evened


def plane(shape: tuple[int, int] = (40, 60)) -> np.ndarray:
    v, u = np.mgrid[: shape[0], : shape[1]]
    return np.asarray(0.25 + 0.001 * u - 0.002 * v, np.float32)


def test_a_plane_stays_as_it_is() -> None:
    flat = plane()
    even = evened(flat, np.ones(flat.shape, np.bool_), np.full(flat.shape, 1e-4, np.float32))
    np.testing.assert_allclose(even, flat, atol=1e-6)


def test_noise_of_a_plane_is_averaged_over_25_pixels(rng: np.random.Generator) -> None:
    noise = rng.normal(0.0, 1e-4, (40, 60)).astype(np.float32)
    even = evened(plane() + noise, np.ones((40, 60), np.bool_), np.full((40, 60), 1e-3, np.float32))
    assert float((even - plane())[2:-2, 2:-2].std()) == pytest.approx(1e-4 / 5.0, rel=0.1)


def test_edges_and_what_is_not_known_stay_sharp() -> None:
    step = plane()
    step[:, 30:] += 0.05
    is_sure = np.ones(step.shape, np.bool_)
    is_sure[20] = False
    step[20] = 0.0
    even = evened(step, is_sure, np.full(step.shape, 1e-3, np.float32))
    np.testing.assert_allclose(even, step, atol=1e-6)
