import numpy as np
import pytest

from peopleboy.tracker.thermal.config import BoxConfig, ContourConfig
from peopleboy.tracker.thermal.contour.outline import box_of, outline
from peopleboy.tracker.thermal.ellipse import Ellipse
from peopleboy.tracker.thermal.variants import PAPER, THESIS

ELLIPSE = Ellipse(x=100, y=120, w=12, h=44, d=3, vx=0, vy=0, vw=0, vh=0)


def test_the_thesis_box_is_2_w_by_3_5_h_from_the_top_of_the_head():
    assert box_of(ELLIPSE, BoxConfig(), 4.4) == pytest.approx((88, 120 - 44 - 20, 24, 154))
    assert THESIS.box.height_per_h == 3.5


def test_the_paper_box_is_3_h_high():
    assert box_of(ELLIPSE, PAPER.box, 4.4)[3] == pytest.approx(132)


def test_hair_raises_the_top_of_the_box_and_nothing_else():
    bald, haired = (box_of(ELLIPSE, BoxConfig(hair_per_h=hair), 4.4) for hair in (0.0, 0.1))
    assert haired == pytest.approx((bald[0], bald[1] - 4.4, bald[2], bald[3]))


def test_the_outline_spans_body_and_head():
    body, head = outline(ELLIPSE, ContourConfig(), count=721)
    assert np.allclose([body.min(axis=0), body.max(axis=0)], [[88, 76], [112, 164]], atol=0.01)
    assert np.allclose([head.min(axis=0), head.max(axis=0)], [[95.5, 56], [110.5, 76]], atol=0.01)
    assert np.allclose(body[0], body[-1], atol=1e-4)
