"""What colours somebody has, on images of closed form."""

from __future__ import annotations

import numpy as np
import pytest

from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame
from peopleboy.tracker.rgbd.observation_model import similarity
from peopleboy.tracker.sensors.depth_visibility import colours
from tests.helpers.depth_scene import FOCAL_PX, HEIGHT, WIDTH, Block, depth_of, make_view

TALL_M = 1.65
SHIRT, TROUSERS, OTHER = (230, 20, 20), (20, 20, 230), (20, 230, 20)


def frame_of(someone: Block, *others: Block) -> Frame:
    """Somebody in a shirt and trousers; everything else has one other colour."""
    depth = depth_of([someone, *others])
    image = np.full((HEIGHT, WIDTH, 3), OTHER, np.uint8)
    off_m = (np.arange(WIDTH) - (WIDTH - 1) / 2) / FOCAL_PX * someone.z_m - someone.x_m
    own = (depth == round(1000 * someone.z_m)) & (np.abs(off_m) <= someone.width_m / 2)
    belt = (HEIGHT - 1) / 2 + (1.2 - 0.85) * FOCAL_PX / someone.z_m
    image[own] = TROUSERS
    image[own & (np.arange(HEIGHT) < belt)[:, None]] = SHIRT
    return Frame(
        images={DEPTH: depth, DEPTH_COLOUR: image}, time_s=0.0, calibrations={DEPTH: make_view().calibration}
    )


def looks_of(someone: Block, *others: Block) -> np.ndarray | None:
    return colours(np.array([someone.z_m + 0.1, -someone.x_m]), TALL_M, frame_of(someone, *others))


@pytest.mark.parametrize("covered_m", [0.1, 0.2, 0.3])
def test_half_a_person_looks_like_a_whole_one(covered_m: float) -> None:
    """One half is the shirt's and one the trousers', and nothing of the one in front, whatever is covered."""
    someone = Block(0.0, 5.0)
    front = Block((covered_m - 0.225) / 5.0 * 3.0 - 0.4, 3.0, width_m=0.8)
    whole, half = looks_of(someone), looks_of(someone, front)
    assert whole is not None
    assert half is not None
    assert whole.sum() == pytest.approx(1.0)
    assert sorted(whole[whole > 0.0]) == pytest.approx([0.43, 0.57], abs=0.05)
    assert similarity(whole, half) > 0.999


def test_who_stands_behind_or_a_little_off_leaves_no_colours() -> None:
    someone = Block(0.0, 5.0)
    alone, before = looks_of(someone), looks_of(someone, Block(0.2, 6.0))
    assert alone is not None
    assert before is not None
    assert similarity(alone, before) == pytest.approx(1.0)


def test_nobody_has_colours_who_is_covered_or_elsewhere() -> None:
    someone = Block(0.0, 5.0)
    assert looks_of(someone, Block(0.0, 3.0, width_m=0.9)) is None
    frame = frame_of(someone)
    assert colours(np.array([-3.0, 0.0]), TALL_M, frame) is None
    assert colours(np.array([5.1, 2.0]), TALL_M, frame) is None
    assert colours(np.array([5.1, 0.0]), TALL_M, Frame(images={}, time_s=0.0)) is None
