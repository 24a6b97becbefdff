"""Tests of the torso in the depth image, on images of closed form."""

import pytest

from peopleboy.tracker.sensors.depth.depth_visibility import Torso, find_torso
from peopleboy.tracker.sensors.depth.pre_detection import PreDetection
from tests.helpers.depth_scene import FOCAL_PX, HEIGHT, WIDTH, Block, depth_of

PERSON = Block(0.3, 4.0, width_m=0.4)
TALL_PX = FOCAL_PX * PERSON.height_m / PERSON.z_m


def torso_of(*blocks: Block) -> Torso | None:
    """Return the torso of the first of several blocks."""
    one = blocks[0]
    scale = FOCAL_PX / one.z_m
    left, top = (one.x_m - one.width_m / 2) * scale + (WIDTH - 1) / 2, (1.2 - one.height_m) * scale
    found = PreDetection(
        box=(left, top + (HEIGHT - 1) / 2, one.width_m * scale, one.height_m * scale),
        x_m=one.x_m,
        z_m=one.z_m,
        width_m=one.width_m,
        height_m=one.height_m,
        depth_m=0.1,
        probability=1.0,
    )
    return find_torso(found, TALL_PX, depth_of(blocks))


def test_a_visible_torso_has_its_middle_and_width() -> None:
    torso = torso_of(PERSON)
    assert torso is not None
    assert torso.middle_px == pytest.approx((WIDTH - 1) / 2 + 0.3 * FOCAL_PX / 4.0, abs=1.0)
    assert torso.width_px == pytest.approx(0.4 * FOCAL_PX / 4.0, abs=1.0)


def test_an_arm_below_the_elbow_does_not_move_the_torso() -> None:
    arm = Block(0.6, 4.0, width_m=0.2, height_m=1.0)
    assert torso_of(PERSON, arm) == torso_of(PERSON)


def test_a_torso_is_unknown_if_something_nearer_hides_a_side_or_the_image_ends() -> None:
    assert torso_of(PERSON, Block(0.45, 2.5, width_m=0.3)) is None
    assert torso_of(Block(2.1, 4.0, width_m=0.4)) is None
