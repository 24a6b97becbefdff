"""The view of a level camera, from the images of a pitched one."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.studies.reproductions.experiments.playback import play
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, THERMAL, Frame
from peopleboy.tracker.sensors.depth.depth_sensor import DepthSensor
from peopleboy.tracker.sensors.depth.depth_view import DepthView, LevelView
from peopleboy.tracker.trackers import make_tracker
from peopleboy.tracker.tracking.config import STATURE_M
from tests.helpers.depth_scene import HEIGHT, WIDTH, Block, depth_of, make_view
from tests.tracker.sensors.depth.test_depth_sensor import predictions

SOMEONE = Block(0.4, 4.0)
POSES = [(-10.0, 1.0), (8.0, 1.2), (16.0, 1.6), (25.0, 2.0)]


def pitched_frame(pitch_deg: float, height_m: float, *blocks: Block) -> Frame:
    """Images of blocks from a height, in grey."""
    pitch_rad = math.radians(pitch_deg)
    return Frame(
        images={
            DEPTH: depth_of(blocks, height_m=height_m, pitch_rad=pitch_rad),
            DEPTH_COLOUR: np.full((HEIGHT, WIDTH, 3), 90, np.uint8),
            THERMAL: np.full((12, 16), 40, np.uint8),
        },
        time_s=0.0,
        calibrations={DEPTH: make_view(height_m, pitch_rad).calibration},
    )


def level_of(frame: Frame) -> LevelView:
    """The level view of a frame's camera."""
    return LevelView.of(DepthView.of(frame.calibrations[DEPTH], DEPTH).calibration, (HEIGHT, WIDTH))


def test_a_level_camera_keeps_its_images() -> None:
    frame = pitched_frame(0.0, 1.2, SOMEONE)
    boxes = np.array([[10.0, 20.0, 30.0, 40.0]])
    assert level_of(frame).transform_frame(frame) is frame
    assert level_of(frame).boxes_in_image(boxes) is boxes


@pytest.mark.parametrize(("pitch_deg", "height_m"), POSES)
def test_points_stay_where_they_are(pitch_deg: float, height_m: float) -> None:
    frame = pitched_frame(pitch_deg, height_m, SOMEONE)
    seen = level_of(frame).transform_frame(frame)
    rows, columns = np.nonzero(seen.depth(DEPTH))
    pixels = np.stack([columns, rows], axis=1).astype(float)
    points = seen.calibrations[DEPTH].rays(pixels) * seen.depth(DEPTH)[rows, columns, None] / 1000.0
    is_front = np.abs(points[:, 0] - SOMEONE.z_m) < 0.01
    assert np.count_nonzero(is_front) > 1000
    front = points[is_front & (points[:, 2] > 0.1 - height_m) & (points[:, 2] < 2.0 - height_m)]
    assert -front[:, 1].mean() == pytest.approx(SOMEONE.x_m, abs=0.02)
    assert np.ptp(front[:, 1]) == pytest.approx(SOMEONE.width_m, abs=0.05)
    assert front[:, 2].max() == pytest.approx(SOMEONE.height_m - height_m, abs=0.02)
    assert seen.images[THERMAL].shape == (12, 16)


@pytest.mark.parametrize("pitch_deg", [-89.0, -60.0, 60.0, 90.0])
def test_a_steep_camera_keeps_its_view(pitch_deg: float) -> None:
    assert level_of(pitched_frame(pitch_deg, 1.2)).level_from_image is None


@pytest.mark.parametrize(("pitch_deg", "height_m"), POSES)
def test_a_person_is_measured_alike_by_pitched_cameras(pitch_deg: float, height_m: float) -> None:
    frame = pitched_frame(pitch_deg, height_m, SOMEONE)
    found = DepthSensor().detect(frame, predictions())
    assert found is not None
    (state,) = found.measurement.initiate([0]).mean
    assert state[[0, 2]] == pytest.approx([SOMEONE.x_m, SOMEONE.z_m + 0.115], abs=0.05)
    assert STATURE_M * np.exp(state[6]) == pytest.approx(SOMEONE.height_m, abs=0.06)


@pytest.mark.parametrize(("pitch_deg", "height_m"), POSES)
def test_a_box_encloses_the_person_in_the_camera_image(pitch_deg: float, height_m: float) -> None:
    frame = pitched_frame(pitch_deg, height_m, SOMEONE)
    found, level = (
        DepthSensor().detect(each, predictions()) for each in (frame, pitched_frame(0.0, height_m, SOMEONE))
    )
    assert found is not None
    assert level is not None
    left, top, width, height = found.boxes[0]
    middle = -SOMEONE.x_m
    ends = np.array(
        [[4.1, middle, 1.65], [4.0, middle, 0.0], [4.0, middle + 0.225, 1.1], [4.0, middle - 0.225, 1.1]]
    )
    head, foot, first, last = frame.calibrations[DEPTH].project(ends)
    assert (top, top + height) == pytest.approx((head[1], foot[1]), abs=4.0)
    assert left + width / 2.0 == pytest.approx((first[0] + last[0]) / 2.0, abs=3.0)
    at_level = make_view(height_m).calibration.project(ends[2:])
    stretched = (last[0] - first[0]) / (at_level[1, 0] - at_level[0, 0])
    assert width == pytest.approx(level.boxes[0, 2] * stretched, rel=0.05)


@pytest.mark.parametrize(("pitch_deg", "away_m"), [(16, 3.0), (16, 4.0), (0, 1.1)])
def test_boxes_of_rendered_people_are_those_of_the_ground_truth(
    pitch_deg: int, away_m: float, tmp_path: Path
) -> None:
    camera = {"kind": "depth", "preset": "kinect", "mount_m": [0.0, 0.0, 1.5], "pitch_deg": pitch_deg}
    scenario = parse_scenario(
        {
            "name": "near",
            "description": "A person stands before the camera.",
            "duration_s": 0.5,
            "place": {"kind": "room", "length_m": 8.0, "width_m": 6.0},
            "people": [{"name": "anna", "path": [{"at_m": [0.6 + away_m, 0.2]}]}],
            "robot": {"at_m": [0.6, 0.0], "cameras": {"depth": camera}},
        },
        source="near.yaml",
        folder=tmp_path,
    )
    tracker = make_tracker("rgbd", 0)
    for moment in play(scenario, 4, DEPTH, images=(DEPTH, DEPTH_COLOUR)):
        tracks = tracker.update(moment.frame)
    (track,) = tracks
    (person,) = moment.truth.people
    assert person.box is not None
    assert iou(np.array(track.boxes[DEPTH]), np.array(person.box)) > 0.7
