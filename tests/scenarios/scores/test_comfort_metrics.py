import json
import math
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.scores.by_tracker import ScoredRun, comfort_by_tracker
from peopleboy.scenarios.scores.comfort_metrics import score_comfort, score_nearness
from peopleboy.sim.robot.robot_body import RADIUS_M
from peopleboy.tracker.evaluation.evaluate import evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from tests.helpers.drives import made_drive

STEP_S = 0.5
_ONE = np.ones(1)
NOTHING = evaluate(
    TrueBoxes(frame=_ONE, id=_ONE, box=np.ones((1, 4)), counted=_ONE, visible=_ONE),
    TrackBoxes(frame=_ONE, id=_ONE, box=np.ones((1, 4)), confidence=_ONE),
    frames=1,
)


def scored(gap, *, x=None, soonest=None, speed=0.0):
    frames = len(gap)
    x = np.zeros(frames) if x is None else np.array(x)
    run = made_drive(3.0 + STEP_S * np.arange(frames), np.stack([x, 0.0 * x, 0.0 * x], axis=1))
    times = np.full(frames, math.inf) if soonest is None else np.array(soonest)
    run = replace(run, speed_m_s=np.broadcast_to(np.array(speed, float), frames))
    return score_nearness(run, np.array(gap, float), times)


def test_time_within_spaces_is_that_of_their_frames_and_intrusions_are_their_starts():
    score = scored([2.0, 1.0, 0.4, 1.0, 0.4, 2.0])
    assert (score.personal_s, score.intimate_s) == (4 * STEP_S, 2 * STEP_S)
    assert (score.personal_intrusions, score.intimate_intrusions) == (1, 2)
    assert math.isnan(score.min_time_to_collision_s)


def test_only_a_robot_that_drives_intrudes_and_nearly_collides():
    speed = [0.5, 0.0, -0.5, 0.5, 0.04, 0.5]
    score = scored([1.0, 1.0, 1.0, 2.0, 1.0, 1.0], soonest=[1.0, 1.0, 2.0, 1.0, 1.0, 9.0], speed=speed)
    assert score.driving_personal_s == 2 * STEP_S  # the last frame has no duration
    assert score.driving_at_people_s == 2 * STEP_S


def test_jerk_is_that_of_the_forward_speed_and_felt_only_by_who_is_near():
    x = (STEP_S * np.arange(9)) ** 3 / 6.0  # jerk 1
    near = scored([3.0] * 9, x=x)
    assert (near.jerk_m_s3, near.felt_jerk_m_s3) == pytest.approx((1.0, 1.0))
    far = scored([4.0] * 9, x=x)
    assert far.jerk_m_s3 == pytest.approx(1.0)
    assert math.isnan(far.felt_jerk_m_s3)
    assert scored([3.0] * 9, x=0.3 * np.arange(9)).jerk_m_s3 == pytest.approx(0.0, abs=1e-9)


def test_the_least_time_to_collision_is_told_unless_it_is_far_off():
    assert scored([2.0] * 3, soonest=[math.inf, 2.5, 4.0]).min_time_to_collision_s == 2.5
    assert math.isnan(scored([2.0] * 3, soonest=[math.inf, 31.0, 90.0]).min_time_to_collision_s)


def test_gaps_are_to_the_nearest_person_of_each_frame_and_times_to_the_first_collision():
    people = np.array([(9.0, 0.0, 0.0, 0.0), (RADIUS_M + 1.0, 0.0, 0.0, 0.0), (5.0, 5.0, 0.0, 0.0)])
    robot, times_s = np.zeros((3, 3)), STEP_S * np.arange(3)
    drive = made_drive(times_s, robot, people=people, count=np.array([2, 0, 1]), speed_m_s=np.full(3, 1.0))
    score = score_comfort(drive)
    assert (score.personal_s, score.personal_intrusions, score.intimate_s) == (STEP_S, 1, 0.0)
    assert score.min_time_to_collision_s == pytest.approx(0.75)


def test_arrays_that_do_not_belong_together_are_refused():
    with pytest.raises(BadInput, match="shapes"):
        made_drive(np.zeros(0), np.zeros((0, 3)))
    with pytest.raises(BadInput, match="shapes"):
        made_drive(np.arange(2.0), np.zeros((2, 3)), count=np.array([0, 1]))
    with pytest.raises(BadInput, match="increase"):
        made_drive(np.zeros(2), np.zeros((2, 3)))


def test_comfort_of_runs_is_the_mean_over_those_that_tell_it(tmp_path):
    counts = scored([2.0, 1.0, 2.0])
    for name, figures in (
        ("a", counts.to_json()),
        ("b", scored([2.0] * 3).to_json()),
        ("c", None),
    ):
        (tmp_path / name).mkdir()
        metrics = {} if figures is None else {"comfort": figures}
        (tmp_path / name / "metrics.json").write_text(json.dumps(metrics), encoding="utf-8")
    groups = {
        "one": [ScoredRun(str(tmp_path / name), "one", None, NOTHING) for name in ("a", "b")],
        "two": [ScoredRun(str(tmp_path / "c"), "two", None, NOTHING)],
    }
    means = comfort_by_tracker(groups)
    assert list(means) == ["one"]
    assert means["one"].personal_s == STEP_S / 2.0
    assert math.isnan(means["one"].min_time_to_collision_s)
    (tmp_path / "a" / "metrics.json").write_text('{"comfort": {"personal_s": 1.0}}', encoding="utf-8")
    with pytest.raises(BadInput, match="not the metrics of this version"):
        comfort_by_tracker(groups)
