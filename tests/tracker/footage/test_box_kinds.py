"""Boxes of torsos, and of whole people."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.footage.box_kinds import (
    TORSO_PER_HEIGHT,
    WHOLE_PER_HEIGHT,
    BoxKind,
    boxed_whole,
    person_of,
    torso_of,
    whole_of,
)
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Status, Track

TORSO, WHOLE = (40.0, 10.0, 22.0, 100.0), (28.62, 9.5, 45.76, 104.0)


def truth(*widths: float) -> TrueBoxes:
    count = len(widths)
    return TrueBoxes(
        frame=np.arange(1, count + 1),
        id=np.ones(count, int),
        box=np.array([(10.0, 20.0, width, 100.0) for width in widths]).reshape(-1, 4),
        counted=np.ones(count, bool),
        visible=np.ones(count),
    )


def frame(height: int = 200, width: int = 200) -> Frame:
    return Frame(images={"thermal": np.zeros((height, width), np.uint8)}, time_s=0.0)


def track(**boxes: dict[str, tuple[float, float, float, float]]) -> Track:
    return Track(id=1, confidence=1.0, status=Status.TRACKED, age_s=1.0, **boxes)


@pytest.mark.parametrize(
    ("widths", "kind"),
    [
        ((17.0, 22.0, 27.0), BoxKind.TORSO),
        ((27.0, 38.0, 53.0), BoxKind.WHOLE),
        ((22.0, 22.0, 90.0), BoxKind.TORSO),  # one of somebody whose arms are spread
        ((), BoxKind.WHOLE),
    ],
)
def test_what_boxes_are_drawn_round_is_told_by_how_wide_most_are(
    widths: tuple[float, ...], kind: BoxKind
) -> None:
    assert BoxKind.of(truth(*widths)) is kind


def test_known_edges_are_the_sides_of_a_whole_box_with_margins() -> None:
    _, top, _, height = whole_of(TORSO)
    middle = TORSO[0] + TORSO[2] / 2.0 + 0.5
    known = whole_of(TORSO, (-0.10, 0.25))
    np.testing.assert_allclose(known, (middle - 14.0, top, 43.0, height))
    found = track(boxes={"thermal": TORSO}, edges=(-0.10, 0.25))
    assert boxed_whole([found], frame())[0].boxes == {"thermal": pytest.approx(known)}


def test_the_person_in_a_whole_box_has_its_edges_and_no_margins() -> None:
    left, top, width, height = person_of(whole_of(TORSO, (-0.10, 0.25)))
    np.testing.assert_allclose((left, top, width, height), (41.0, TORSO[1], 35.0, TORSO[3]))


def test_boxes_without_height_tell_nothing() -> None:
    flat = truth(20.0, 40.0)
    box = flat.box.copy()
    box[0, 3] = 0.0
    given = TrueBoxes(frame=flat.frame, id=flat.id, box=box, counted=flat.counted, visible=flat.visible)
    assert BoxKind.of(given) is BoxKind.WHOLE


def test_whole_people_are_boxed_in_every_image() -> None:
    torso = track(boxes={"thermal": TORSO, "colour": TORSO})
    image = np.zeros((200, 200), np.uint8)
    (whole,) = boxed_whole([torso], Frame(images={"thermal": image, "colour": image}, time_s=0.0))
    assert whole.boxes == {"thermal": pytest.approx(WHOLE), "colour": pytest.approx(WHOLE)}


def test_boxes_of_whole_people_end_at_the_borders_of_the_image() -> None:
    left, top, width, _ = WHOLE
    (whole,) = boxed_whole([track(boxes={"thermal": TORSO})], frame(height=60, width=50))
    assert whole.boxes["thermal"] == pytest.approx((left, top, 50.0 - left, 60.0 - top))
    assert left + width > 50.0


def test_boxes_in_images_that_were_not_taken_go_on() -> None:
    (whole,) = boxed_whole([track(boxes={"colour": TORSO})], frame(width=50))
    assert whole.boxes["colour"] == pytest.approx(WHOLE)


def test_who_is_outside_the_image_has_no_box_in_it() -> None:
    (whole,) = boxed_whole([track(boxes={"thermal": TORSO})], frame(width=20))
    assert whole.boxes == {}


@given(left=st.floats(-100.0, 500.0), top=st.floats(-100.0, 500.0), height=st.floats(5.0, 400.0))
def test_the_whole_has_the_middle_of_the_torso_and_margins_above_and_below(
    left: float, top: float, height: float
) -> None:
    torso = (left, top, TORSO_PER_HEIGHT * height, height)
    whole = whole_of(torso)
    assert whole[0] + whole[2] / 2.0 == pytest.approx(left + torso[2] / 2.0 + 0.5)
    assert whole[1] == pytest.approx(top + 0.5 - 0.01 * height)
    assert whole[1] + whole[3] == pytest.approx(top + 0.5 + 1.03 * height)
    assert whole[2] == pytest.approx(WHOLE_PER_HEIGHT * whole[3])
    assert torso_of(whole) == pytest.approx(torso)
