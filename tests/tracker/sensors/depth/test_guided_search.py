"""What depth and heat show where somebody stands, on images of closed form."""

from __future__ import annotations

import numpy as np
import pytest

from peopleboy.tracker.frame import DEPTH, THERMAL, Frame
from peopleboy.tracker.sensors.depth.depth_visibility import depth_visibility, warmth
from peopleboy.tracker.sensors.depth.guided_search import search_near
from peopleboy.tracker.sensors.depth.pre_detection import HumanSize, PreDetection, PreDetector
from peopleboy.tracker.sensors.depth.u_depth import UDepthConfig
from tests.helpers.depth_scene import HEIGHT, WIDTH, Block, depth_of, make_view

BODY_M = 0.1
COLD, WARM = 10, 120


def make_frame(*blocks: Block, grey: int = WARM, has_heat: bool = True) -> Frame:
    images = {DEPTH: depth_of(list(blocks))}
    if has_heat:
        images[THERMAL] = np.full((HEIGHT, WIDTH), grey, np.uint8)
    calibration = make_view().calibration
    return Frame(images=images, time_s=0.0, calibrations={DEPTH: calibration, THERMAL: calibration})


def at(block: Block) -> np.ndarray:
    return np.array([block.z_m + BODY_M, -block.x_m])


def test_what_stands_before_and_behind_somebody_is_told() -> None:
    someone = Block(0.0, 5.0)
    seen = depth_visibility(at(someone), 0.45, 1.65, make_frame(someone))
    hidden = depth_visibility(at(someone), 0.45, 1.65, make_frame(Block(0.0, 3.0, width_m=1.0), someone))
    gone = depth_visibility(at(someone), 0.45, 1.65, make_frame())
    assert seen is not None and hidden is not None and gone is not None  # noqa: PT018
    assert (seen.nearer, seen.beyond, seen.warm) == (0.0, 0.0, 1.0)
    assert (hidden.nearer, gone.beyond) == (1.0, 1.0)
    assert depth_visibility(np.array([-2.0, 0.0]), 0.45, 1.65, make_frame()) is None


@pytest.mark.parametrize("covered_m", [0.0, 0.1, 0.2, 0.3])
def test_who_is_covered_in_part_is_found_where_it_stands(covered_m: float) -> None:
    someone = Block(0.2, 5.0)
    inner_m = (0.2 - 0.225 + covered_m) / 5.0 * 3.0  # where the front one's right side ends, at its depth
    front = Block(inner_m - 0.4, 3.0, width_m=0.8)
    found = search_near(at(someone) + np.array([0.05, 0.12]), 0.45, 1.65, make_frame(front, someone))
    assert found is not None
    assert found.place_m == pytest.approx(at(someone), abs=0.05)
    assert found.warm == 1.0


def test_nobody_is_found_where_nobody_is_or_all_is_covered() -> None:
    someone = Block(0.0, 5.0)
    assert search_near(at(someone), 0.45, 1.65, make_frame()) is None
    assert search_near(at(someone), 0.45, 1.65, make_frame(Block(0.0, 3.0, width_m=1.0), someone)) is None


def detected(frame: Frame) -> PreDetection:
    layout = PreDetector(HumanSize(), UDepthConfig())(frame.depth(DEPTH), make_view())
    (found,) = layout.detections
    return found


def test_people_are_told_by_their_heat() -> None:
    someone = Block(0.3, 4.0)
    frame = make_frame(someone)
    warm = warmth(detected(frame), frame)
    assert warm is not None
    assert warm > 0.3
    for other in (make_frame(someone, grey=COLD), make_frame(someone, has_heat=False)):
        assert not (warmth(detected(other), other) or 0.0) > 0.3
