"""What tests of the scene model share."""

from __future__ import annotations

import numpy as np
import pytest


@pytest.fixture
def rng() -> np.random.Generator:
    """Draws the same in every test."""
    return np.random.default_rng(0)
