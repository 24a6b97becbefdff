"""The laser sensor in trackers, on scans of rendered worlds."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.tracker.frame import LASER, Frame
from peopleboy.tracker.sensors.laser.laser_sensor import LaserSensor
from peopleboy.tracker.track import Status, Track
from peopleboy.tracker.trackers import make_tracker

SECONDS = 6.0


def drive() -> Iterator[tuple[Frame, np.ndarray]]:
    """Yield frames of scans alone, and the positions of those whose legs are in view within 6 m."""
    before: Pose2 | None = None
    for world, seen in blind_drive(load_scenario("corridor_legs").lasting(SECONDS), 0):
        scan = {LASER: np.array(seen.images[LASER])}
        truth = world.truth(LASER)
        near = [
            truth.robot.to_local(one.position_m)
            for one in truth.people
            if one.distance_m < 6.0 and one.visible_px > 2
        ]
        frame = Frame.from_observation(seen, before)
        yield (
            Frame(images=scan, time_s=frame.time_s, calibrations=frame.calibrations, odometry=frame.odometry),
            np.array(near).reshape(-1, 2),
        )
        before = seen.odometry


@pytest.fixture(scope="module")
def played() -> list[tuple[tuple[Track, ...], np.ndarray]]:
    tracker = make_tracker("laser")
    return [(tracker.update(frame), people) for frame, people in drive()]


def places(tracks: tuple[Track, ...]) -> np.ndarray:
    found = [one.place.position_m for one in tracks if one.status is not Status.TENTATIVE and one.place]
    return np.array(found).reshape(-1, 2)


def test_people_are_found_by_their_legs_and_furniture_is_not(
    played: list[tuple[tuple[Track, ...], np.ndarray]],
) -> None:
    hits, people, false, tracks = 0, 0, 0, 0
    for found, near in played[15:]:
        away = np.hypot(*(places(found)[:, None] - near).transpose(2, 0, 1))
        hits += int((away < 0.5).any(axis=0).sum()) if len(away) else 0
        people += len(near)
        tracks += len(away)
        false += int((places(found)[:, 0] < 6.0).sum() - (away < 0.5).any(axis=1).sum()) if len(near) else 0
    assert hits > 0.8 * people
    assert false < 0.25 * tracks


def test_tracks_have_no_box_in_the_scan(played: list[tuple[tuple[Track, ...], np.ndarray]]) -> None:
    assert all(LASER not in track.boxes for found, _ in played for track in found)


def test_fused_needs_no_range_finder_and_uses_one_that_is_mounted() -> None:
    assert LASER not in make_tracker("fused").cameras
    scenario = load_scenario("corridor_legs").mounting(("depth",)).lasting(1.0)
    tracker, frames = make_tracker("fused"), []
    for _, seen in blind_drive(scenario, 0):
        frames.append(tracker.update(Frame.from_observation(seen)))
    assert frames[-1]


def test_a_camera_in_place_of_the_range_finder_is_refused() -> None:
    with pytest.raises(BadInput, match="laser"):
        LaserSensor().check_cameras({})
