"""Tests of the depth sensor, on images of closed form."""

from __future__ import annotations

from typing import cast

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame
from peopleboy.tracker.sensors.depth.depth_sensor import DepthSensor, DepthSensorConfig
from peopleboy.tracker.sensors.depth.depth_visibility import describe_readings
from peopleboy.tracker.sensors.depth.window_model import WindowModel
from peopleboy.tracker.tracking.appearance import colour_similarity
from peopleboy.tracker.tracking.config import STATURE_M
from peopleboy.tracker.tracking.motion_filter import STATE, StateEstimates
from peopleboy.tracker.tracking.sensor import Predictions
from tests.helpers.depth_scene import FOCAL_PX, HEIGHT, WIDTH, Block, depth_of, make_view

HEIGHT_M = 1.2
SHIRT, OTHER = (230, 20, 20), (20, 230, 20)


class Sure:
    """A model of windows with one score for all."""

    sees_depth = True

    def __init__(self, score: float) -> None:
        self.score = score

    def look(self, *_: object) -> float:
        return self.score


def frame_of(*blocks: Block, time_s: float = 0.0) -> Frame:
    """Return an image of blocks, the first of which is red."""
    depth = depth_of(blocks)
    image = np.full((HEIGHT, WIDTH, 3), OTHER, np.uint8)
    if blocks:
        off_m = (np.arange(WIDTH) - (WIDTH - 1) / 2) / FOCAL_PX * blocks[0].z_m - blocks[0].x_m
        image[(depth == round(1000 * blocks[0].z_m)) & (np.abs(off_m) <= blocks[0].width_m / 2)] = SHIRT
    return Frame(
        images={DEPTH: depth, DEPTH_COLOUR: image},
        time_s=time_s,
        calibrations={DEPTH: make_view().calibration},
    )


def predictions(*places: tuple[float, float]) -> Predictions:
    """Return confirmed tracks at places to the right and ahead, known to 10 cm."""
    count = len(places)
    mean, covariance = np.zeros((count, STATE)), np.tile(0.01 * np.eye(STATE), (count, 1, 1))
    mean[:, (0, 2)], mean[:, 1] = np.reshape(places, (count, 2)), HEIGHT_M
    return Predictions(
        keys=tuple(range(count)),
        states=StateEstimates(mean, covariance),
        ratio=np.full(count, 0.27),
        log_odds=np.full(count, 8.0),
        is_confirmed=np.ones(count, bool),
        origin_m=(0.0, 0.0, HEIGHT_M),
    )


def test_an_object_of_human_size_is_measured_where_it_stands() -> None:
    found = DepthSensor().detect(frame_of(Block(0.5, 4.0)), predictions())
    assert found is not None
    (state,) = found.measurement.initiate([0]).mean
    assert state[[0, 2]] == pytest.approx([0.5, 4.115], abs=0.05)
    assert STATURE_M * np.exp(state[6]) == pytest.approx(1.65, abs=0.06)


def test_an_equal_image_is_no_new_one() -> None:
    sensor, frame = DepthSensor(), frame_of(Block(0.5, 4.0))
    assert sensor.detect(frame, predictions()) is not None
    assert sensor.detect(frame, predictions()) is None


def test_visibility_says_who_is_hidden_and_who_is_gone() -> None:
    frame = frame_of(Block(0.5, 4.0), Block(-1.0, 3.0, width_m=0.9))
    seen = DepthSensor().visibility(frame, predictions((0.5, 4.1), (-1.3, 4.1), (2.0, 6.0)))
    assert seen is not None
    assert seen.is_present.tolist() == [True, False, False]
    assert seen.is_absent.tolist() == [False, False, True]
    assert seen.hidden[0] < 0.1 < 0.9 < seen.hidden[1]


def test_a_half_covered_person_is_found_near_the_prediction() -> None:
    frame = frame_of(Block(0.0, 4.0), Block(-0.35, 2.5, width_m=0.6))
    found = DepthSensor().detect(frame, predictions((0.0, 4.1)))
    assert found is not None
    assert 0 in found.assigned or any(
        abs(x) < 0.2 and abs(z - 4.1) < 0.2
        for x, z in found.measurement.initiate(range(len(found))).mean[:, (0, 2)]
    )


def test_what_is_found_near_a_prediction_is_classified_where_no_thermal_image_shows_it() -> None:
    frame = frame_of(Block(0.0, 4.0), Block(-0.35, 2.5, width_m=0.6))
    config = DepthSensorConfig(own_m=0.0)
    for score in (-1.0, 0.7, 9.0):
        found = DepthSensor(config, model=cast(WindowModel, Sure(score))).detect(
            frame, predictions((0.0, 4.1))
        )
        assert found is not None
        log_odds = found.scores[found.assigned[0]]
        expected = min(max(config.score_gain * (score - config.neutral_far), -config.most), 1.0)
        assert log_odds == pytest.approx(expected), score


def test_a_near_person_has_a_box_from_the_usual_head_where_the_image_cuts_it_off() -> None:
    frame = frame_of(Block(0.0, 1.0))  # the image shows up to 1.6 m
    found = DepthSensor(model=cast(WindowModel, Sure(1.0))).detect(frame, predictions())
    assert found is not None
    head = frame.calibrations[DEPTH].project(np.array([[1.1, 0.0, STATURE_M]]))
    assert found.boxes[0, 1] == pytest.approx(head[0, 1], abs=3.0)
    assert found.boxes[0, 1] + found.boxes[0, 3] > HEIGHT


def test_a_head_outside_the_image_keeps_the_stature_of_the_track() -> None:
    here = predictions((0.0, 1.1))
    here.states.mean[0, 6] = np.log(1.9 / STATURE_M)
    found = DepthSensor().detect(frame_of(Block(0.0, 1.0)), here)
    assert found is not None
    later = found.measurement.update(here.states, [0])
    assert STATURE_M * np.exp(later.mean[0, 6]) == pytest.approx(1.9, abs=0.01)


def test_a_torso_without_head_neither_begins_a_track_nor_counts_against_one() -> None:
    found = DepthSensor(model=cast(WindowModel, Sure(-5.0))).detect(
        frame_of(Block(0.0, 1.0), Block(0.9, 4.0)), predictions()
    )
    assert found is not None
    assert found.scores == pytest.approx([-0.6, -3.0])
    assert found.scores[0] < found.settings.existence.birth


def test_colours_are_those_of_the_persons_own_readings() -> None:
    someone, front = Block(0.0, 5.0), Block(-0.4, 3.0, width_m=0.8)
    place = np.array([5.1, 0.0])
    whole, half = (
        describe_readings(frame_of(*those), place, 1.65) for those in ((someone,), (someone, front))
    )
    assert whole.any()
    assert colour_similarity(whole, half) > 0.99


def test_a_depth_camera_without_calibration_is_refused() -> None:
    with pytest.raises(BadInput, match="calibrated"):
        DepthSensor().check_cameras({})
