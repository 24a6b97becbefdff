"""Where an image is looked at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.sensors.thermal.detection_schedule import DetectionSchedule, Schedule, ThermalMemory
from peopleboy.tracker.sensors.thermal.template import Template
from peopleboy.tracker.tracking.config import DetectionScheduleConfig
from peopleboy.tracker.tracking.motion_filter import STATE, StateEstimates
from peopleboy.tracker.tracking.sensor import Predictions

CONFIG = DetectionScheduleConfig()
DT_S = 1.0 / 15.0
GREY = np.random.default_rng(0).integers(0, 256, (240, 320)).astype(np.uint8)
BOXES = np.array([[40.0, 60.0, 27.0, 100.0], [200.0, 60.0, 27.0, 100.0]])


@dataclass(slots=True)
class Known:
    """A track of the schedule: what the sensor remembers, and whether the track is confirmed."""

    memory: ThermalMemory
    box: Floats
    is_confirmed: bool = True
    log_odds: float = 8.0


def targets(boxes: Floats = BOXES) -> list[Known]:
    return [
        Known(ThermalMemory(0.0, float(number), 2.0, 0.0, template=Template.of(GREY, box)), box)
        for number, box in enumerate(boxes, 1)
    ]


def memories(known: list[Known]) -> list[ThermalMemory]:
    return [one.memory for one in known]


def predictions(known: list[Known]) -> Predictions:
    count = len(known)
    return Predictions(
        keys=tuple(range(count)),
        states=StateEstimates(np.zeros((count, STATE)), np.zeros((count, STATE, STATE))),
        ratio=np.full(count, 0.27),
        log_odds=np.array([one.log_odds for one in known]),
        is_confirmed=np.array([one.is_confirmed for one in known], bool),
        origin_m=None,
    )


def aims(
    known: list[Known],
    images: int,
    boxes: Floats = BOXES,
    config: DetectionScheduleConfig = CONFIG,
    breadth: float = CONFIG.breadth,
) -> list[Schedule]:
    """Schedule equal images, in which every person is detected who was detected before."""
    schedule, found = DetectionSchedule(), []
    for image in range(images):
        time_s = image * DT_S
        last_s = max(image - 1, 0) * DT_S
        kept = memories(known)
        found.append(schedule.schedule_next(GREY, predictions(known), kept, boxes, time_s, breadth, config))
        for row, memory in enumerate(kept):
            if memory.seen_s == last_s:
                memory.seen_s = time_s
                memory.rescored_s = memory.rescored_s if row in found[-1].followed else time_s
                is_anew = found[-1].everywhere and row not in found[-1].expected
                memory.searched_s = time_s if is_anew else memory.searched_s
    return found


def everywhere(result: list[Schedule]) -> list[int]:
    return [image for image, aim in enumerate(result) if aim.everywhere]


def test_five_of_six_images_are_not_searched_where_it_is_clear_who_is_there() -> None:
    assert everywhere(aims(targets(), 19)) == [0, 6, 12, 18]


@pytest.mark.parametrize(("breadth", "searched"), [(2.0, 6), (1.0, 6), (0.7, 4), (0.5, 3), (0.1, 3)])
def test_a_narrower_camera_is_searched_more_often_but_no_more_than_where_it_is_open_who_is_there(
    breadth: float, searched: int
) -> None:
    result = aims(targets(), 19, breadth=breadth * CONFIG.breadth)
    assert everywhere(result) == list(range(0, 19, searched))


@pytest.mark.parametrize("open_", ["nobody", "untold", "lost"])
def test_two_of_three_are_not_where_that_is_open(open_: str) -> None:
    who = [] if open_ == "nobody" else targets()
    if open_ == "untold":
        who[1].is_confirmed = False
    if open_ == "lost":
        who[1].memory.seen_s = -0.1
    assert everywhere(aims(who, 10, BOXES[: len(who)])) == [0, 3, 6, 9]


def test_who_is_lost_outside_the_image_or_for_long_leaves_nothing_open() -> None:
    who, boxes = targets(), BOXES.copy()
    who[1].memory.seen_s = -0.1
    boxes[1, 0] = 330.0
    assert everywhere(aims(who, 10, boxes)) == [0, 6]
    who = targets()
    who[1].memory.seen_s = -CONFIG.lost_s
    assert everywhere(aims(who, 10)) == [0, 6]


def test_who_stands_apart_is_followed_by_his_portrait_for_a_while() -> None:
    result = aims(targets(), 6)
    for image in (1, 2, 4, 5):
        assert list(result[image].followed) == [0, 1]
        np.testing.assert_allclose(list(result[image].followed.values()), BOXES, atol=0.5)
        assert not result[image].expected
    aim = result[3]  # 0.2 s after the last look
    assert list(aim.expected) == [0, 1]
    assert aim.proposed(memories(targets())).trees.tolist() == [2.0, 1.0]


def close() -> list[Known]:
    return targets(BOXES + np.array([[140.0], [0.0]]) * [1.0, 0.0, 0.0, 0.0])


def untold() -> list[Known]:
    first, second = targets()
    return [replace(first, is_confirmed=False), replace(second, log_odds=-0.1)]


def unlike() -> list[Known]:
    known = targets()
    for one in known:
        one.memory.template = Template.of(GREY.T.copy(), one.box)
    return known


@pytest.mark.parametrize("make", [close, untold, unlike])
def test_the_detector_looks_at_who_is_near_others_or_unsure_or_looks_different(
    make: Callable[[], list[Known]],
) -> None:
    who = make()
    aim = aims(who, 2, np.array([one.box for one in who]))[1]
    assert not aim.followed
    assert sorted(aim.expected) == [0, 1]


def test_who_is_partly_outside_the_image_is_looked_at() -> None:
    boxes = BOXES + np.array([[-50.0], [0.0]]) * [1.0, 0.0, 0.0, 0.0]
    assert list(aims(targets(boxes), 2, boxes)[1].followed) == [1]


def test_who_is_followed_is_as_sure_as_when_looked_at() -> None:
    seen = Schedule(True, {}, {1: BOXES[1] + 1.0}).located(memories(targets()))
    np.testing.assert_array_equal(seen.box, [BOXES[1] + 1.0])
    assert (seen.score.tolist(), seen.trees.tolist()) == ([2.0], [2.0])


def test_every_image_is_searched_everywhere_where_no_pause_is_asked_for() -> None:
    config = DetectionScheduleConfig(unsettled_s=0.0, settled_s=0.0, anew_s=0.0)
    assert everywhere(aims(targets(), 5, config=config)) == [0, 1, 2, 3, 4]


def test_two_of_three_searches_pass_by_who_stands_apart() -> None:
    result = aims(targets(), 25)
    assert [list(result[image].expected) for image in (0, 6, 12, 18, 24)] == [[], [0, 1], [0, 1], [], [0, 1]]


@pytest.mark.parametrize("make", [close, untold])
def test_no_search_passes_by_who_is_near_others_or_unsure(make: Callable[[], list[Known]]) -> None:
    who = make()
    result = aims(who, 13, np.array([one.box for one in who]))
    assert not any(aim.expected for aim in result if aim.everywhere)
