from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from benchmarks.compare import Turns
from benchmarks.speed.contour_tracker import ContourTimes, CrowdTime
from benchmarks.speed.memory import MemoryCurve, memory_curve
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
    turns = Turns()
    for slow in (1.0, 1.0, 2.0, 2.0, 1.5):
        turns.add({"contour": 2.0 * slow, "step": 0.1 * slow, "default": 10.0 * slow, "HOG": 60.0 * slow})
    assert [turns.ratio("HOG", name) for name in ("contour", "step", "default")] == [30.0, 600.0, 6.0]
    assert (turns.median("contour"), turns.least("HOG")) == (3.0, 60.0)


def test_contestants_take_turns_in_order_and_one_that_was_left_out_counts_for_nothing() -> None:
    calls: list[str] = []
    turns = Turns()
    for _ in range(2):
        turns.measure({name: partial(calls.append, name) for name in "ab"})
    assert calls == ["a", "b"] * 2
    assert [len(turns.values[name]) for name in "ab"] == [2, 2]
    turns.add({"c": np.nan})
    turns.add({"c": 3.0})
    assert turns.median("c") == 3.0
