import numpy as np

from peopleboy.tracker.reproductions.contour.explanation import Ellipse
from peopleboy.tracker.reproductions.contour.measurement.section_evidence import outline

ELLIPSE = Ellipse(x=100, y=120, w=12, h=44, d=3, vx=0, vy=0, vw=0, vh=0)


def test_the_outline_spans_body_and_head():
    body, head = outline(ELLIPSE, count=721)
    assert np.allclose([body.min(axis=0), body.max(axis=0)], [[88, 76], [112, 164]], atol=0.01)
    assert np.allclose([head.min(axis=0), head.max(axis=0)], [[95.5, 56], [110.5, 76]], atol=0.01)
    assert np.allclose(body[0], body[-1], atol=1e-4)
