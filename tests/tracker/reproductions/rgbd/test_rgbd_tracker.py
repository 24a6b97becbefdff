"""People tracked by depth and colour."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame, Odometry
from peopleboy.tracker.reproductions.rgbd.rgbd_config import PRINTED, HypothesesConfig, RgbdConfig
from peopleboy.tracker.reproductions.rgbd.rgbd_tracker import RgbdTracker
from peopleboy.tracker.sensors.depth.window_model import shipped_windows
from peopleboy.tracker.track import Status, Track
from tests.helpers.depth_scene import HEIGHT, WIDTH, Block, depth_of, make_view

COLOURS = {"anna": (200, 30, 30), "bert": (30, 30, 200)}


def make_tracker(seed: int = 0, births: int = 1) -> RgbdTracker:
    """Everything of the size of a human is taken for one: blocks have no heads."""
    config = RgbdConfig(has_verification=False, hypotheses=HypothesesConfig(births=births))
    return RgbdTracker(config, shipped_windows(sees_depth=True), np.random.default_rng(seed))


def make_frame(k: int, people: dict[str, Block], odometry: Odometry | None = None) -> Frame:
    depth = depth_of(list(people.values()))
    colour = np.full((HEIGHT, WIDTH, 3), 120, np.uint8)
    for name, block in people.items():
        colour[depth == round(1000 * block.z_m)] = COLOURS[name]
    return Frame(
        images={DEPTH: depth, DEPTH_COLOUR: colour},
        time_s=k / 15.0,
        calibrations={DEPTH: make_view().calibration},
        odometry=odometry,
    )


def watch(tracker: RgbdTracker, frames: Iterable[Frame]) -> list[tuple[Track, ...]]:
    return [tracker.update(frame) for frame in frames]


@pytest.mark.parametrize("births", [1, 2])
def test_somebody_is_believed_in_when_verified_so_often_and_keeps_the_number(births: int) -> None:
    tracker = make_tracker(births=births)
    told = watch(tracker, (make_frame(k, {"anna": Block(0.04 * k - 0.6, 4.0)}) for k in range(30)))
    assert [len(tracks) for tracks in told[:3]] == ([1, 1, 1] if births == 1 else [0, 1, 1])
    assert {track.id for tracks in told[2:] for track in tracks} == {1}
    x, y = told[-1][0].place.position_m  # type: ignore[union-attr]
    assert (x, y) == pytest.approx((4.1, -0.56), abs=0.1)


def test_while_a_slower_camera_takes_no_image_people_walk_on_and_the_robot_may_turn() -> None:
    turn = Odometry(turn_rad=0.01)
    told = []
    tracker = make_tracker()
    for k in range(45):
        angle = 0.01 * k
        # Anna walks to the right at 0.6 m/s, seen from a robot that turns left.
        x, z = 0.04 * k - 0.9, 4.0
        seen = Block(x * math.cos(angle) + z * math.sin(angle), z * math.cos(angle) - x * math.sin(angle))
        frame = make_frame(k, {"anna": seen}, turn if k else Odometry())
        told.append(tracker.update(frame if k % 3 == 0 else replace(frame, images={})))
    assert {track.id for tracks in told for track in tracks} == {1}
    assert [len(tracks) for tracks in told[3:]] == [1] * 42
    for k in (42, 43, 44):
        (track,) = told[k]
        assert track.place is not None
        ahead, left = track.place.position_m
        x, z = 0.04 * k - 0.9, 4.0
        angle = 0.01 * k
        assert left == pytest.approx(-(x * math.cos(angle) + z * math.sin(angle)), abs=0.12), k
        assert ahead == pytest.approx(z * math.cos(angle) - x * math.sin(angle) + 0.1, abs=0.15), k


def test_people_who_cross_keep_their_numbers() -> None:
    ways = ({"anna": Block(0.05 * k - 1.2, 4.0), "bert": Block(1.2 - 0.05 * k, 5.5)} for k in range(50))
    told = watch(make_tracker(), (make_frame(k, way) for k, way in enumerate(ways)))
    sides = [
        {track.id: track.place.position_m[1] > 0 for track in tracks if track.place}
        for tracks in (told[4], told[-1])
    ]
    assert len(sides[0]) == len(sides[1]) == 2
    assert sides[1] == {number: not is_left for number, is_left in sides[0].items()}


def test_who_is_hidden_says_by_whom() -> None:
    ways = ({"anna": Block(0.0, 3.5, width_m=0.6), "bert": Block(1.2 - 0.05 * k, 5.5)} for k in range(25))
    told = watch(make_tracker(), (make_frame(k, way) for k, way in enumerate(ways)))
    hidden = [track for track in told[-1] if track.status is Status.TOTALLY_OCCLUDED]
    front = next(track for track in told[-1] if track.place and track.place.position_m[0] < 4.5)
    assert [track.occluder for track in hidden] == [front.id]


def test_who_was_there_is_gone_once_the_camera_sees_through() -> None:
    there = (make_frame(k, {"anna": Block(0.0, 4.0)}) for k in range(10))
    gone = (make_frame(10 + k, {}) for k in range(8))
    tracker = make_tracker()
    assert len(watch(tracker, there)[-1]) == 1
    assert watch(tracker, gone)[-1] == ()


def test_who_leaves_the_image_is_told_of_for_a_second_and_known_for_longer() -> None:
    tracker, turn, still = make_tracker(), Odometry(turn_rad=0.7), Odometry()
    watch(tracker, (make_frame(k, {"anna": Block(0.0, 4.0)}) for k in range(10)))
    away = (make_frame(10 + k, {}, still if k else turn) for k in range(40))
    shown = [len(tracks) for tracks in watch(tracker, away)]
    assert shown[10] == 1
    assert shown[-1] == 0
    back = (
        make_frame(50 + k, {"anna": Block(0.0, 4.0)}, still if k else Odometry(turn_rad=-0.7))
        for k in range(4)
    )
    again = watch(tracker, back)
    assert [track.id for track in again[-1]] == [1]


def test_a_turn_of_the_robot_is_not_taken_for_a_step() -> None:
    def seen_from(turn_rad: float) -> dict[str, Block]:
        return {"anna": Block(5.0 * math.sin(turn_rad), 5.0 * math.cos(turn_rad))}

    step = math.radians(3.0)
    tracker = make_tracker()
    watch(tracker, (make_frame(k, seen_from(0.0)) for k in range(10)))
    told = watch(
        tracker, (make_frame(10 + k, seen_from((k + 1) * step), Odometry(turn_rad=step)) for k in range(6))
    )
    assert {track.id for tracks in told for track in tracks} == {1}
    x, y = told[-1][0].place.position_m  # type: ignore[union-attr]
    assert math.atan2(y, x) == pytest.approx(-6 * step, abs=0.03)


def test_the_same_seed_gives_the_same_tracks() -> None:
    ways = [{"anna": Block(0.05 * k - 1.2, 4.0), "bert": Block(1.2 - 0.05 * k, 5.5)} for k in range(30)]
    one, other = (
        watch(make_tracker(7), (make_frame(k, way) for k, way in enumerate(ways))) for _ in range(2)
    )
    assert one == other


def test_the_printed_tracker_leaves_walls_in() -> None:
    assert not PRINTED.above.has_walls


def test_colour_of_another_size_is_refused() -> None:
    frame = make_frame(0, {})
    images = {**frame.images, DEPTH_COLOUR: np.zeros((10, 10, 3), np.uint8)}
    with pytest.raises(BadInput, match="must show the same pixels"):
        make_tracker().update(Frame(images=images, time_s=0.0, calibrations=frame.calibrations))


def test_a_camera_without_calibration_is_refused() -> None:
    with pytest.raises(BadInput, match="calibrated"):
        make_tracker().check_cameras({})
