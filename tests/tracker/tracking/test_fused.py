"""Several sensors in one tracker, on rendered images."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import islice

import numpy as np
import pytest

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import DEPTH, PANORAMA, THERMAL, Frame
from peopleboy.tracker.sensors.depth.depth_sensor import DepthExplanation
from peopleboy.tracker.sensors.panorama.panorama_sensor import PanoramaExplanation
from peopleboy.tracker.sensors.thermal.thermal_sensor import DetectionExplanation
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import explanation_of, make_tracker
from peopleboy.tracker.tracking.sensor import parts_of

AHEAD = ("thermal", "colour", "depth")


@cache
def frames(name: str, count: int, cameras: tuple[str, ...]) -> tuple[Frame, ...]:
    scenario = load_scenario(name).mounting(cameras)
    calibrations = calibrations_of(scenario.world(0).robot.cameras)
    made, before = [], None
    for _, seen in islice(blind_drive(scenario, 0), count):
        made.append(Frame.from_observation(seen, before, calibrations))
        list(made[-1].images.values())  # rendered at their time
        before = seen.odometry
    return tuple(made)


def played(name: str, images: Sequence[Frame], without: Sequence[str] = ()) -> Iterator[tuple[Track, ...]]:
    tracker = make_tracker(name)
    for frame in images:
        kept = {camera: image for camera, image in frame.images.items() if camera not in without}
        yield tracker.update(
            Frame(
                images=kept,
                time_s=frame.time_s,
                calibrations=frame.calibrations,
                odometry=frame.odometry,
            )
        )


@pytest.mark.slow
def test_a_person_has_one_track_with_a_box_in_each_image() -> None:
    *_, tracks = played("fused", frames("single_stationary", 60, AHEAD))
    (track,) = tracks
    assert set(track.boxes) == {THERMAL, DEPTH}
    assert track.place is not None


@pytest.mark.slow
@pytest.mark.parametrize("lost", ["thermal", "depth"])
def test_without_one_of_its_cameras_it_goes_on_with_the_other(lost: str) -> None:
    images = frames("single_stationary", 60, AHEAD)
    both = list(played("fused", images))[-1]
    lacking = (lost, "depth_colour") if lost == "depth" else (lost,)
    (track,) = list(played("fused", images, lacking))[-1]
    assert track.place is not None
    assert both[0].place is not None
    assert track.place.position_m == pytest.approx(both[0].place.position_m, abs=0.5)


@pytest.mark.slow
def test_the_panorama_is_used_where_it_is_mounted() -> None:
    images = frames("panoramic_round", 30, (*AHEAD, PANORAMA))
    tracker = make_tracker("fused")
    for frame in images:
        tracks = tracker.update(frame)
    assert any({THERMAL, PANORAMA} <= set(track.boxes) for track in tracks)
    kinds = {type(part) for part in parts_of(explanation_of(tracker))}
    assert kinds == {DetectionExplanation, DepthExplanation, PanoramaExplanation}


@pytest.mark.slow
def test_the_depth_camera_alone_gives_boxes_in_the_thermal_image_too() -> None:
    images = frames("single_stationary", 60, AHEAD)
    both = list(played("fused", images))[-1]
    (track,) = list(played("rgbd", images, ("thermal", "colour")))[-1]
    assert set(track.boxes) == {THERMAL, DEPTH}
    for camera in track.boxes:
        assert iou(np.array(track.boxes[camera]), np.array(both[0].boxes[camera])) > 0.7


def test_the_panorama_is_not_required() -> None:
    assert make_tracker("fused").cameras == ("thermal", "colour", "depth")


@pytest.mark.slow
def test_people_outside_an_image_have_no_box_in_it() -> None:
    images = frames("panoramic_round", 300, ("thermal", "colour", PANORAMA))
    seen = [track for tracks in played("handover", images) for track in tracks]
    behind = [one for one in seen if one.place is not None and one.place.position_m[0] < 0.0]
    assert behind
    assert all(set(one.boxes) == {PANORAMA} for one in behind)
    rows, columns = images[0].images[THERMAL].shape
    for left, top, width, height in (one.boxes[THERMAL] for one in seen if THERMAL in one.boxes):
        assert left < columns
        assert top < rows
        assert left + width > 0.0
        assert top + height > 0.0
