from __future__ import annotations

import numpy as np
import pytest

from benchmarks.memory import MemoryCurve, memory_curve
from benchmarks.speed.beside_hog import BesideHog, Turn
from benchmarks.speed.contour_tracker import ContourTimes, CrowdTime
from peopleboy.tracker.frame import THERMAL, Frame


def test_growth_of_memory_is_the_slope_once_all_is_warm() -> None:
    frames = tuple(range(500, 10_001, 500))
    held = tuple(200.0 if at > 2500 else 0.1 * at for at in frames)
    assert MemoryCurve(frame=frames, resident_mb=held, people=1).bytes_per_frame == pytest.approx(0, abs=1e-6)
    leaking = tuple(at + 2e-6 * frame for at, frame in zip(held, frames, strict=True))
    assert MemoryCurve(frame=frames, resident_mb=leaking, people=1).bytes_per_frame == pytest.approx(2.0)


def test_memory_is_looked_at_twenty_times_until_the_last_frame() -> None:
    image = np.zeros((60, 80), dtype=np.uint8)
    curve = memory_curve((Frame(images={THERMAL: image}, time_s=0.1 * number) for number in range(99)), 50)
    assert curve.frame[-1] == 50
    assert len(curve.frame) == len(curve.resident_mb) == 20
    assert min(curve.resident_mb) > 10
    assert curve.people == 0


def test_a_persons_cost_is_the_slope_over_the_crowds() -> None:
    crowds = tuple(
        CrowdTime(people=people, frame_ms=1.0 + 0.5 * people, frames=9, tracked=people) for people in range(5)
    )
    found = ContourTimes(crowds=crowds, prepare_ms=0.1, parts_ms={})
    assert found.person_ms == pytest.approx(0.5)


def test_a_machine_that_is_slow_for_some_turns_changes_no_ratio() -> None:
    slow = [1.0, 1.0, 2.0, 2.0, 1.5]
    turns = tuple(
        Turn(contour_ms=2.0 * by, step_ms=0.1 * by, default_ms=10.0 * by, hog_ms=60.0 * by) for by in slow
    )
    assert BesideHog(turns).contour_ratio == pytest.approx(30.0)
    assert BesideHog(turns).step_ratio == pytest.approx(600.0)
    assert BesideHog(turns).default_ratio == pytest.approx(6.0)
