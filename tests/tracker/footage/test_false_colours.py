"""Palettes of false colours are recognised, and their levels read."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.tracker.footage.false_colours import FalseColours, Palette, find_palette, palettes


@pytest.fixture(scope="module")
def scene() -> NDArray[np.uint8]:
    """A smooth scene with a warm person."""
    rng = np.random.default_rng(0)
    coarse = rng.uniform(30.0, 140.0, (6, 8)).astype(np.float32)
    picture = cv2.resize(coarse, (160, 120), interpolation=cv2.INTER_CUBIC)
    cv2.ellipse(picture, (80, 60), (10, 34), 0, 0, 360, 215, cv2.FILLED)
    return np.clip(picture, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("palette", palettes(), ids=lambda one: one.name)
def test_levels_of_a_palette_are_read(palette: Palette, scene: NDArray[np.uint8]) -> None:
    coloured, notes = palette.colours[scene], []
    grey = FalseColours().grey(coloured, notes)
    assert np.abs(grey.astype(int) - scene).max() <= 3  # some palettes have a colour twice
    assert notes == [f"pictures have the false colours {palette.name}, which were turned to grey"]


def test_levels_survive_compression(scene: NDArray[np.uint8]) -> None:
    for palette in palettes():
        code = cv2.imencode(".jpg", palette.colours[scene][..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 90])[1]
        coloured = cv2.imdecode(code, cv2.IMREAD_COLOR)[..., ::-1]
        off = np.abs(FalseColours().grey(np.ascontiguousarray(coloured), []).astype(int) - scene)
        assert np.median(off) <= 4, palette.name


def test_the_first_palette_stays(scene: NDArray[np.uint8]) -> None:
    colours, notes = FalseColours(), []
    jet = next(one for one in palettes() if one.name == "jet")
    for _ in range(2):
        np.testing.assert_array_equal(colours.grey(jet.colours[scene], notes), jet.grey(jet.colours[scene]))
    assert len(notes) == 1


def test_other_colours_become_their_brightness() -> None:
    rng = np.random.default_rng(1)
    colours = rng.integers(0, 256, (120, 160, 3), dtype=np.uint8)
    notes: list[str] = []
    assert find_palette(colours) is None
    grey = FalseColours().grey(colours, notes)
    np.testing.assert_array_equal(grey, cv2.cvtColor(colours, cv2.COLOR_RGB2GRAY))
    assert "need not keep warm above cold" in notes[0]


def test_grey_in_three_channels_stays_grey(scene: NDArray[np.uint8]) -> None:
    notes: list[str] = []
    np.testing.assert_array_equal(FalseColours().grey(np.dstack([scene] * 3), notes), scene)
    np.testing.assert_array_equal(FalseColours().grey(scene, notes), scene)
    assert not notes
