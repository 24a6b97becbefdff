import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.behaviours.following.target import (
    OccluderConfig,
    Target,
    TargetConfig,
    bearing,
    hider,
    keep_behind,
)
from peopleboy.behaviours.percept import SeenPerson

CONFIG, VIEW = OccluderConfig(), TargetConfig()
TARGET = Target(id=1, seen_s=0.0, bearing_rad=0.1, drift_rad_s=0.0, height=0.5)


def somebody(bearing_rad, height=0.7, number=2, *, is_visible=True):
    """A person in the image at that bearing."""
    x = -math.tan(bearing_rad) / math.tan(VIEW.half_view_rad)
    return SeenPerson(
        id=number, x=x, height=height, top=0.2, bottom=0.9, confidence=1.0, is_visible=is_visible
    )


def test_who_stands_nearer_on_the_same_line_hides_the_person():
    near, nearest = somebody(0.15), somebody(0.12, number=3)
    assert hider([near, nearest], TARGET, CONFIG, VIEW) is nearest


@pytest.mark.parametrize(
    "other",
    [
        somebody(0.1, height=0.3),
        somebody(0.1, number=1),
        somebody(0.1, is_visible=False),
        somebody(0.5),
        somebody(0.1, height=math.nan),
    ],
    ids=["farther", "itself", "hidden too", "elsewhere", "no number"],
)
def test_nobody_else_does(other):
    assert hider([other], TARGET, CONFIG, VIEW) is None
    assert keep_behind(TARGET, [other], CONFIG, VIEW) is TARGET


@given(st.floats(-0.15, 0.15))
def test_a_hidden_person_is_supposed_behind_whoever_hides_it_and_moved_no_farther_than_needed(off):
    other = somebody(TARGET.bearing_rad + off)
    kept = keep_behind(TARGET, [other], CONFIG, VIEW).bearing_rad
    half = CONFIG.half_width * other.height
    middle = bearing(other.x, VIEW)
    assert abs(kept - middle) <= half + 1e-9
    assert kept == pytest.approx(TARGET.bearing_rad) or abs(kept - middle) == pytest.approx(half)
