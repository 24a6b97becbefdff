"""Tests of the tracker by detection, on proposals that are made up and on its own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.scheduled_detector import ScheduledDetector
from peopleboy.tracker.sensors.thermal.thermal_sensor import ThermalSensor
from peopleboy.tracker.track import Status, Track
from peopleboy.tracker.tracking.config import (
    AssociationConfig,
    ExistenceConfig,
    KalmanConfig,
    PeopleTrackerConfig,
)
from peopleboy.tracker.tracking.measurement import BoxMeasurement
from peopleboy.tracker.tracking.motion_filter import predicted_boxes
from peopleboy.tracker.tracking.people_tracker import PeopleTracker
from peopleboy.tracker.tracking.sensor import (
    Predictions,
    SensorDetections,
    Settings,
    Visibility,
    no_appearance,
)
from peopleboy.tracker.tracking.viewpoint import Viewpoint

RATE_HZ = 15.0
RED, BLUE = (200, 30, 30), (30, 30, 200)
AS_CALIBRATED = PeopleTrackerConfig(
    existence_uncalibrated=ExistenceConfig(), association_uncalibrated=AssociationConfig()
)
Box = tuple[float, float, float, float]


class FixedDetections:
    """A finder that is told what to find."""

    def __init__(self, boxes: Sequence[Sequence[Box]], score: float = 3.0) -> None:
        self._boxes, self._score = iter(boxes), score
        self.expected: list[Detections] = []
        self.everywhere: list[int] = []

    def __call__(self, frame: Frame, expected: Detections, *, everywhere: bool) -> Detections:  # noqa: ARG002
        if everywhere:
            self.everywhere.append(len(self.expected))
        self.expected.append(expected)
        boxes = np.array(next(self._boxes), np.float64).reshape(-1, 4)
        return Detections.of(boxes, np.full(len(boxes), self._score), np.arange(1.0, 1.0 + len(boxes)))


def walker(middle: float, height: float = 100.0) -> Box:
    return middle - 0.135 * height, 60.0, 0.27 * height, height


def frames(boxes: Sequence[Sequence[Box]], clothes: Sequence[tuple[int, int, int]] = ()) -> Iterator[Frame]:
    """Draw nothing but clothes, one colour for each box."""
    for number, here in enumerate(boxes):
        picture = np.full((240, 320, 3), 120, np.uint8)
        for box, colour in zip(here, clothes, strict=False):
            left, top, width, height = (round(value) for value in box)
            picture[top : top + height, max(left, 0) : max(left + width, 0)] = colour
        images = {THERMAL: np.zeros((240, 320), np.uint8), COLOUR: picture}
        yield Frame(images=images if clothes else {THERMAL: images[THERMAL]}, time_s=number / RATE_HZ)


CAMERA = PinholeCalibration(
    np.array([[300.0, 0, 159.5], [0, 300, 119.5], [0, 0, 1]]),
    np.array([[0.0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 1.2], [0, 0, 0, 1]]),
)


def standing(right_m: float) -> Box:
    """Give the box of somebody 1.72 m tall, 5 m in front of the robot."""
    feet, head = CAMERA.project(np.array([[5.0, -right_m, 0.0], [5.0, -right_m, 1.72]]))
    height = float(feet[1] - head[1])
    return float(feet[0]) - 0.135 * height, float(head[1]), 0.27 * height, height


def calibrated(boxes: Sequence[Sequence[Box]], rate_hz: float = RATE_HZ) -> Iterator[Frame]:
    for number, frame in enumerate(frames(boxes)):
        yield replace(frame, time_s=number / rate_hz, calibrations={THERMAL: CAMERA})


def fixed_sensor(find: FixedDetections, config: PeopleTrackerConfig | None = None) -> ThermalSensor:
    return ThermalSensor(config, ScheduledDetector(config, find))


def tracked(
    boxes: Sequence[Sequence[Box]],
    score: float = 3.0,
    clothes: Sequence[tuple[int, int, int]] = (),
    config: PeopleTrackerConfig | None = None,
) -> list[tuple[Track, ...]]:
    tracker = PeopleTracker((fixed_sensor(FixedDetections(boxes, score), config),), config)
    return [tracker.update(frame) for frame in frames(boxes, clothes)]


def numbers(tracks: tuple[Track, ...]) -> set[int]:
    return {track.id for track in tracks if track.status is Status.TRACKED}


def test_who_walks_is_told_within_a_second_and_keeps_one_number() -> None:
    boxes = [[walker(60.0 + 3.0 * i)] for i in range(45)]
    seen = tracked(boxes)
    assert all(numbers(tracks) == {1} for tracks in seen[15:])
    assert seen[-1][0].boxes[THERMAL] == pytest.approx(boxes[-1][0], abs=3.0)


def test_who_is_seen_by_a_known_camera_has_a_place_on_the_floor_and_nobody_else() -> None:
    boxes = [[standing(0.8)]] * 10
    tracker = PeopleTracker((fixed_sensor(FixedDetections(boxes)),))
    (track,) = [tracker.update(frame) for frame in calibrated(boxes)][-1]
    assert track.place is not None
    expected = (5.0 + KalmanConfig().toe_m, -0.8)  # the feet end at the front foot
    assert track.place.position_m == pytest.approx(expected, abs=0.02)
    assert [track.place for track in tracked(boxes)[-1]] == [None]


def test_what_looks_rather_unlike_a_person_is_not_told() -> None:
    assert not any(tracked([[walker(100.0)]] * 90, score=-0.6))
    assert tracked([[walker(100.0)]] * 90, score=1.6)[-1]


def test_somebody_sure_is_told_by_the_second_image_of_a_known_camera_and_the_fourth_of_another() -> None:
    boxes = [[walker(100.0)]] * 4
    assert [len(tracks) for tracks in tracked(boxes, config=AS_CALIBRATED)] == [0, 1, 1, 1]
    assert [len(tracks) for tracks in tracked(boxes, score=3.5)] == [0, 0, 0, 1]


def test_who_walks_briskly_past_a_camera_of_which_nothing_is_known_is_kept() -> None:
    boxes = [[walker(40.0 + 5.0 * i)] for i in range(40)]
    assert all(numbers(tracks) == {1} for tracks in tracked(boxes)[8:])


def test_whom_one_image_shows_beyond_doubt_is_told_at_once() -> None:
    boxes = [[walker(100.0)]] * 4
    seen = tracked(boxes, score=4.5, config=AS_CALIBRATED)
    assert [len(tracks) for tracks in seen] == [1, 1, 1, 1]
    assert [len(tracks) for tracks in tracked(boxes, score=4.5)] == [0, 0, 0, 1]


def test_a_camera_that_is_calibrated_is_one_that_is_known() -> None:
    tracker = PeopleTracker((fixed_sensor(FixedDetections([[standing(0.0)]] * 4)),))
    seen = [tracker.update(frame) for frame in calibrated([[standing(0.0)]] * 4)]
    assert [len(tracks) for tracks in seen] == [0, 1, 1, 1]


def test_a_second_box_on_somebody_known_is_nobody_new() -> None:
    one, larger = walker(100.0), (80.0, 40.0, 40.0, 150.0)
    seen = tracked([[one]] * 10 + [[one, larger]] * 20, score=2.0, config=AS_CALIBRATED)
    assert all(numbers(tracks) <= {1} for tracks in seen)
    assert numbers(seen[-1]) == {1}


def test_two_who_cross_keep_their_numbers() -> None:
    boxes = [[walker(60.0 + 4.0 * i), walker(240.0 - 4.0 * i, 90.0)] for i in range(45)]
    seen = tracked(boxes, clothes=(RED, BLUE))
    first = {track.id: track.boxes[THERMAL][0] for track in seen[15]}
    last = {track.id: track.boxes[THERMAL][0] for track in seen[-1]}
    assert first.keys() == last.keys() == {1, 2}
    for number in (1, 2):
        assert (first[number] < 120.0) == (last[number] > 150.0)


@pytest.mark.parametrize(("again", "number"), [(RED, 1), (BLUE, 2)])
def test_who_comes_back_elsewhere_in_the_same_colours_keeps_the_number_and_nobody_else_does(
    again: tuple[int, int, int], number: int
) -> None:
    away = [[walker(60.0 + 3.0 * i)] for i in range(30)] + [[]] * 60
    back = [[walker(250.0 - 3.0 * i)] for i in range(30)]
    tracker = PeopleTracker((fixed_sensor(FixedDetections(away + back)),))
    shots = [*frames(away, (RED,))]
    shots += [
        Frame(images=frame.images, time_s=frame.time_s + len(away) / RATE_HZ)
        for frame in frames(back, (again,))
    ]
    seen = [tracker.update(frame) for frame in shots]
    assert numbers(seen[29]) == {1}
    assert not seen[80]
    assert numbers(seen[-1]) == {number}


BLACK = (0, 0, 0)  # too dark to compare
Part = tuple[int, float | None, tuple[int, int, int]]
"""Number of frames, where a person stands to the right [m] (None if there is no person), and the clothes."""
LEAVES, HIDDEN_CLOTHES = [(40, 0.0, RED), (8, None, RED)], (6, 0.3, BLACK)


def tracked_parts(parts: Sequence[Part]) -> list[tuple[Track, ...]]:
    boxes = [[] if at_m is None else [standing(at_m)] for count, at_m, _ in parts for _ in range(count)]
    clothes = [colour for count, _, colour in parts for _ in range(count)]
    tracker = PeopleTracker((fixed_sensor(FixedDetections(boxes)),))
    images = (next(frames([here], (colour,))) for here, colour in zip(boxes, clothes, strict=True))
    return [
        tracker.update(replace(image, time_s=number / RATE_HZ, calibrations={THERMAL: CAMERA}))
        for number, image in enumerate(images)
    ]


@pytest.mark.parametrize(("clothes", "ids"), [(RED, {1}), (BLUE, {2})])
def test_a_person_at_the_place_of_a_lost_one_gets_another_id_once_the_clothes_are_seen(
    clothes: tuple[int, int, int], ids: set[int]
) -> None:
    seen = tracked_parts([*LEAVES, HIDDEN_CLOTHES, (25, 0.3, clothes)])
    assert numbers(seen[53]) == {1}
    assert numbers(seen[-1]) == ids


def test_a_lost_person_whose_id_another_one_had_for_a_moment_gets_it_back() -> None:
    seen = tracked_parts([*LEAVES, HIDDEN_CLOTHES, (20, 0.3, BLUE), (8, None, BLUE), (20, 0.0, RED)])
    assert numbers(seen[73]) == {2}
    assert numbers(seen[-1]) == {1}


def test_who_is_behind_somebody_is_said_to_be_hidden_by_them() -> None:
    front = walker(160.0, 150.0)
    boxes = [
        [walker(40.0 + 4.0 * i, 80.0), front] if abs(40.0 + 4.0 * i - 160.0) > 15.0 else [front]
        for i in range(45)
    ]
    hidden = [
        track for tracks in tracked(boxes) for track in tracks if track.status is Status.TOTALLY_OCCLUDED
    ]
    assert hidden
    assert {track.occluder for track in hidden} == {1} or {track.occluder for track in hidden} == {2}


def test_nobody_is_told_outside_the_image() -> None:
    boxes = [[walker(120.0 + 8.0 * i)] if 120.0 + 8.0 * i < 330.0 else [] for i in range(40)]
    seen = tracked(boxes, config=AS_CALIBRATED)
    assert len(seen[20]) == 1
    result = [track.boxes[THERMAL] for tracks in seen for track in tracks]
    assert max(left for left, *_ in result) < 319.5
    assert not seen[-1]


def test_in_five_of_six_images_only_who_was_just_seen_is_looked_for_where_he_is_expected() -> None:
    boxes = [[standing(0.05 * i - 1.0), standing(1.5)] for i in range(20)] + [[standing(1.5)]] * 4
    find = FixedDetections(boxes)
    tracker = PeopleTracker((fixed_sensor(find),))
    for frame in calibrated(boxes):
        tracker.update(frame)
    # Nobody is told in the first image; somebody is lost in that with number 20.
    assert find.everywhere == [0, 6, 12, 18, 21]
    both, alone = find.expected[19], find.expected[22]
    np.testing.assert_allclose(both.box[::-1], boxes[19], atol=3.0)
    assert both.trees.tolist() == both.score.tolist() == [2.0, 1.0]  # as trees said of the image before
    np.testing.assert_allclose(alone.box, boxes[22], atol=3.0)


def test_who_stands_apart_is_followed_without_the_detector() -> None:
    boxes = [[standing(0.02 * i - 0.2)] for i in range(14)]
    grey = np.random.default_rng(0).integers(0, 60, (240, 320)).astype(np.uint8)
    person = np.kron(np.random.default_rng(1).integers(100, 250, (40, 10)), np.ones((6, 6))).astype(np.uint8)
    find = FixedDetections(
        [box if number in (0, 1, 4, 6, 9, 12) else [] for number, box in enumerate(boxes)], score=4.5
    )
    tracker, seen = PeopleTracker((fixed_sensor(find),)), []
    for frame, ((left, top, width, height),) in zip(calibrated(boxes), boxes, strict=True):
        image = grey.copy()
        image[round(top) : round(top + height), round(left) : round(left + width)] = person[
            : round(top + height) - round(top), : round(left + width) - round(left)
        ]
        seen.append(tracker.update(replace(frame, images={THERMAL: image})))
    assert find.everywhere == [0, 6, 12]
    assert [number for number, one in enumerate(find.expected) if len(one.box)] == [1, 4, 9, 12]
    np.testing.assert_allclose(find.expected[12].box, boxes[12], atol=3.0)  # trees pass him by there
    for number in (2, 3, 5, 7, 8, 10, 11, 13):
        assert [track.status for track in seen[number]] == [Status.TRACKED]
        assert seen[number][0].boxes[THERMAL] == pytest.approx(boxes[number][0], abs=3.0)


def test_every_image_of_a_slow_camera_or_one_that_is_not_known_is_searched_everywhere() -> None:
    boxes = [[standing(0.0)]] * 10
    for shots in (calibrated(boxes, rate_hz=2.5), frames(boxes)):
        find = FixedDetections(boxes)
        tracker = PeopleTracker((fixed_sensor(find),))
        for frame in shots:
            tracker.update(frame)
        assert find.everywhere == list(range(10))


def test_nobody_new_is_begun_with_where_only_others_are_looked_for() -> None:
    one, other = standing(-1.0), standing(1.0)
    for later, result in (([[one, other], [one, other], [one]], {1}), ([[one], [one], [one, other]], {1, 2})):
        boxes = [[one]] * 10 + later * 5
        tracker = PeopleTracker((fixed_sensor(FixedDetections(boxes, score=4.5)),))
        seen = [numbers(tracker.update(frame)) for frame in calibrated(boxes)]
        assert set().union(*seen) == result


def test_who_is_pointed_out_is_told_at_once() -> None:
    boxes = [[walker(100.0 + 2.0 * i)] for i in range(5)]
    tracker = PeopleTracker((fixed_sensor(FixedDetections(boxes)),))
    tracker.introduce(boxes[0][0])
    seen = [tracker.update(frame) for frame in frames(boxes)]
    assert all({track.id for track in tracks} == {1} for tracks in seen)


def test_time_must_go_forward() -> None:
    tracker = PeopleTracker((fixed_sensor(FixedDetections([[], []])),))
    frame = next(frames([[]]))
    tracker.update(frame)
    with pytest.raises(BadInput, match="time_s must go forward"):
        tracker.update(frame)


class Occluder:
    """A sensor without detections, which knows what hides people."""

    cameras = ("depth",)
    explanation = None

    def __init__(self, hidden: Sequence[float]) -> None:
        self._hidden = iter(hidden)

    def check_cameras(self, calibrations: object) -> None:
        """Accept all."""

    def detect(self, frame: Frame, predicted: Predictions) -> SensorDetections:  # noqa: ARG002
        view = Viewpoint.of(None, (240, 320))
        boxes = np.empty((0, 4))
        pattern, colours = no_appearance(0)
        config = PeopleTrackerConfig()
        return SensorDetections(
            camera="depth",
            boxes=boxes,
            scores=np.empty(0),
            measurement=BoxMeasurement(boxes, view, config.motion),
            expected=predicted_boxes(predicted.states, view, predicted.ratio),
            pattern=pattern,
            colours=colours,
            settings=Settings(config.existence, config.association, config.reidentification),
        )

    def detect_in(self, frame: Frame, box: object, predicted: Predictions) -> None:
        """Leave boxes to others."""

    def visibility(self, frame: Frame, predicted: Predictions) -> Visibility:  # noqa: ARG002
        count, hidden = len(predicted), next(self._hidden)
        nothing = np.zeros(count, bool)
        return Visibility(np.full(count, hidden), nothing, np.full(count, hidden < 0.0))

    def project(self, frame: Frame, predicted: Predictions) -> None:
        """Give no boxes."""

    def remember(self, detections: object, found: object, keys: object) -> None:
        """Remember nothing."""


def statuses(hidden: float) -> list[list[Status]]:
    """Detect a person for 20 images, and then no more, while something hides a share of the person."""
    boxes = [[standing(0.8)]] * 20 + [[]] * 10
    sensors = (fixed_sensor(FixedDetections(boxes)), Occluder([hidden] * 60))
    tracker = PeopleTracker(sensors)
    return [[track.status for track in tracker.update(frame)] for frame in calibrated(boxes)]


def test_a_person_whom_a_thing_hides_coasts_as_one_whom_a_person_hides() -> None:
    assert statuses(0.9)[21:28] == [[Status.TOTALLY_OCCLUDED]] * 7
    assert statuses(0.0)[21] == [Status.PARTLY_OCCLUDED]
    assert statuses(0.0)[-1] == []


def test_a_track_in_front_of_visible_background_ends_at_once() -> None:
    assert statuses(-1.0)[-5:] == [[]] * 5


def test_the_trackers_of_several_sensors_want_all_cameras() -> None:
    tracker = PeopleTracker((ThermalSensor(), Occluder([])))
    assert tracker.cameras == (THERMAL, COLOUR, "depth")
