from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.contour_config import TrackerConfig
from peopleboy.tracker.reproductions.contour.explanation import ContourExplanation, Ellipse
from peopleboy.tracker.reproductions.contour.measurement.contour import (
    FEET,
    HEAD_ASPECT,
    SECTIONS,
    SHOULDER_LEFT,
    SIDE_LEFT,
    SIDE_RIGHT,
)
from peopleboy.tracker.reproductions.contour.measurement.likelihood import ContourModel
from peopleboy.tracker.reproductions.contour.measurement.section_evidence import (
    evidence_of,
    outline,
    section_lines,
)
from peopleboy.tracker.reproductions.contour.particles import HEAD_DIVISOR
from peopleboy.tracker.reproductions.contour.variants import VARIANTS
from peopleboy.tracker.track import Status, Track

CONTOUR = VARIANTS["contour"]
AT_REST = {"vx": 0.0, "vy": 0.0, "vw": 0.0, "vh": 0.0}
STANDING = Ellipse(x=160.0, y=120.0, w=20.0, h=45.0, d=0.0, **AT_REST)


def track(number: int = 1, occluder: int | None = None) -> Track:
    return Track(
        id=number,
        boxes={"thermal": (0.0, 0.0, 1.0, 1.0)},
        confidence=1.0,
        status=Status.TRACKED,
        age_s=1.0,
        occluder=occluder,
    )


def explain(config: TrackerConfig = CONTOUR, *ellipses: Ellipse) -> ContourExplanation:
    """The explanation of tracks 1, 2, ... with these contours; of one who stands if none are given."""
    told = dict(enumerate(ellipses or (STANDING,), 1))
    return ContourExplanation(config=config, ellipses=told, spread_px2=dict.fromkeys(told, 1.0))


def person(ellipse: Ellipse = STANDING) -> NDArray[np.uint8]:
    """(240, 320) a warm body and head where the contour is, legs and all."""
    v, u = np.mgrid[:240, :320].astype(float)
    head = ellipse.h / HEAD_DIVISOR
    body = ((u - ellipse.x) / ellipse.w) ** 2 + ((v - ellipse.y) / ellipse.h) ** 2 < 1
    top = ellipse.y - ellipse.h - head
    face = ((u - ellipse.x) / (HEAD_ASPECT * head)) ** 2 + ((v - top) / head) ** 2 < 1
    legs = (abs(u - ellipse.x) < 0.6 * ellipse.h) & (v > ellipse.y) & (v < ellipse.y + 2.05 * ellipse.h)
    return np.where(body | face | legs, 150, 5).astype(np.uint8)


@pytest.mark.parametrize("name", VARIANTS)
def test_what_is_wholly_in_view_responds_as_the_tracker_measures_it(name: str) -> None:
    config, image = VARIANTS[name], person()
    model = ContourModel.build((240, 320), config.contour)
    state = np.array([[160.0, 120.0, 20.0, 45.0, 0.0, 0.0, 0.0, 0.0, 0.0]], np.float32)
    measured = model.differences(model.prepare(image), state)[0]
    evidence = evidence_of(image, [track()], explain(config))[1]
    has_feet = config.contour.feet_weight > 0
    used = slice(None) if has_feet else slice(FEET)
    assert evidence.response[used] == pytest.approx(measured[used], abs=1e-5)
    assert np.isnan(evidence.response[FEET]) != has_feet
    assert evidence.seen == pytest.approx(np.ones(8))


def test_an_occluder_s_body_hides_the_sections_on_its_side() -> None:
    front = replace(STANDING, x=185.0)
    tracks = [track(), track(2), track(3, occluder=2)]
    evidence = evidence_of(person(), tracks, explain(CONTOUR, STANDING, front, STANDING))
    assert evidence[1].seen == pytest.approx(np.ones(8))
    assert evidence[3].seen[SIDE_RIGHT] == pytest.approx(0.0)
    assert np.isnan(evidence[3].response[SIDE_RIGHT])
    for section in (SHOULDER_LEFT, SIDE_LEFT):
        assert evidence[3].response[section] == pytest.approx(evidence[1].response[section], abs=0.02)


def test_an_empty_image_speaks_for_nobody() -> None:
    evidence = evidence_of(np.full((240, 320), 40, np.uint8), [track()], explain())[1]
    assert evidence.response == pytest.approx(np.zeros(8))


@given(x=st.floats(-400, 700), y=st.floats(-300, 500), h=st.floats(0.5, 150), d=st.floats(-40, 40))
def test_evidence_is_between_minus_one_and_one_or_out_of_view_anywhere(
    x: float, y: float, h: float, d: float
) -> None:
    ellipse = Ellipse(x=x, y=y, w=0.4 * h, h=h, d=d, **AT_REST)
    evidence = evidence_of(person(), [track()], explain(CONTOUR, ellipse))[1]
    assert ((evidence.seen >= 0) & (evidence.seen <= 1)).all()
    assert np.array_equal(np.isnan(evidence.response), evidence.seen == 0)
    assert (np.abs(evidence.response[~np.isnan(evidence.response)]) <= 1 + 1e-5).all()


def test_sections_are_drawn_along_the_outlines_and_none_over_another() -> None:
    lines = section_lines(STANDING, CONTOUR.contour)
    assert len(lines) == SECTIONS + 1
    body, head = outline(STANDING, count=3000)
    around = np.concatenate([body, head])
    for line in np.delete(lines, FEET, axis=0):
        away = np.linalg.norm(line[:, None] - around[None], axis=2).min(axis=1)
        assert away.max() < 0.1
    middles = np.array([line[2] for line in lines])
    assert len(np.unique(np.round(middles), axis=0)) == SECTIONS + 1
