"""Tests of users' detectors, and of files of detections, as detectors of the thermal sensor."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.scenarios.loop.tracker_by_name import tracker_cameras
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.sensors.own_detector import FileDetector, NetworkDetector, OwnDetector
from peopleboy.tracker.sensors.thermal.detector.people_network import NetworkDetections, PeopleNetwork
from peopleboy.tracker.sensors.thermal.thermal_sensor import ThermalSensor
from peopleboy.tracker.track import Status, Track, TrackPosture
from peopleboy.tracker.trackers import WITH_DETECTOR, is_own, make_tracker
from peopleboy.tracker.tracking.config import DetectorScoreConfig
from peopleboy.tracker.tracking.people_tracker import PeopleTracker
from tests.helpers.calls.refused import refused

Box = tuple[float, float, float, float]
SCORES = DetectorScoreConfig()
WALK = [(60.0 + 3.0 * k, 60.0, 30.0, 100.0) for k in range(45)]
TWO = [(20.0, 30.0, 40.0, 120.0), (200.0, 30.0, 40.0, 120.0)]


class Fixed:
    """A detector with fixed answers, one for each image."""

    def __init__(self, answers: Sequence[Any], **attributes: object) -> None:
        self._answers = iter(answers)
        self.seen: list[np.ndarray] = []
        for name, value in attributes.items():
            setattr(self, name, value)

    def detect(self, image: np.ndarray) -> Any:
        self.seen.append(image)
        return next(self._answers)


def frames(count: int) -> Iterator[Frame]:
    for number in range(count):
        images = {THERMAL: np.zeros((240, 320), np.uint8), COLOUR: np.full((480, 640, 3), 90, np.uint8)}
        yield Frame(images=images, time_s=number / 15.0)


def tracked(detector: Any, given: Sequence[Frame]) -> list[tuple[Track, ...]]:
    tracker = PeopleTracker((ThermalSensor(detector=OwnDetector(detector)),))
    return [tracker.update(frame) for frame in given]


def detections(detector: Any, frame: Frame | None = None) -> tuple[np.ndarray, np.ndarray]:
    sensor = OwnDetector(detector)
    found = sensor.detect(next(frames(1)) if frame is None else frame, None, None, None)  # type: ignore[arg-type]
    assert found is not None
    return found.found.box, found.found.score


def test_a_person_who_walks_keeps_one_track_with_the_boxes_of_the_detector() -> None:
    seen = tracked(Fixed([([box], [0.9]) for box in WALK]), list(frames(45)))
    assert all([track.id for track in tracks] == [1] for tracks in seen[20:])
    assert seen[-1][0].status is Status.TRACKED
    assert seen[-1][0].boxes[THERMAL] == pytest.approx(WALK[-1], abs=3.0)


def test_one_detection_confirms_no_track_however_sure_it_is() -> None:
    once = [(TWO[:1], [1.0]), *[((), ())] * 9]
    assert not any(tracked(Fixed(once), list(frames(10))))


def test_every_image_is_passed_once_and_read_only() -> None:
    detector = Fixed([((), ())] * 5)
    tracked(detector, list(frames(5)))
    assert [image.shape for image in detector.seen] == [(240, 320)] * 5
    with pytest.raises(ValueError, match="read-only"):
        detector.seen[0][0, 0] = 1


def test_probabilities_and_log_odds_that_say_the_same_give_the_same() -> None:
    probability = np.array([0.7, 0.3])
    by_probability = detections(Fixed([(TWO, probability)]))
    by_log_odds = detections(Fixed([(TWO, np.log(probability / (1.0 - probability)))], log_odds=True))
    np.testing.assert_allclose(by_probability[1], by_log_odds[1])
    np.testing.assert_array_equal(by_probability[0], TWO)


def test_certain_scores_are_limited_and_improbable_detections_dropped() -> None:
    box, score = detections(Fixed([(TWO, [1.0, 0.0])]))
    assert (box.tolist(), score.tolist()) == ([list(TWO[0])], [SCORES.most])


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (None, ("must return boxes and scores", "NoneType")),
        (TWO * 2, ("must return boxes and scores", "list of 4")),
        (([TWO[0][:3]], [0.5]), ("(M, 4)", "left, top, width, height", "(1, 3)")),
        ((TWO[0], [0.5]), ("(M, 4)", "(4,)")),
        ((TWO, [0.5]), ("scores must be (2,)", "(1,)")),
        ((TWO, [[0.5], [0.5]]), ("scores must be (2,)", "(2, 1)")),
        (([(0, 0, np.nan, 5)], [0.5]), ("box 0", "finite", "nan")),
        (([(0, 0, 5, -5)], [0.5]), ("box 0", "height > 0", "-5.0")),
        (([(0, 0, 0, 5)], [0.5]), ("box 0", "width > 0", "0.0")),
        (([(2e6, 0, 5, 5)], [0.5]), ("box 0", "2000000.0")),
        ((TWO, [0.5, np.nan]), ("score 1", "finite", "nan")),
        ((TWO, [0.5, 1.5]), ("score 1", "0 to 1", "1.5", "log_odds = True")),
        ((TWO, ["sure", "unsure"]), ("scores must be an array of numbers",)),
        (([[1, 2], [3]], [0.5, 0.5]), ("boxes must be an array of numbers",)),
    ],
)
def test_an_invalid_answer_is_refused_with_what_would_be_right(answer: Any, says: tuple[str, ...]) -> None:
    with refused("detect(image)", *says):
        detections(Fixed([answer]))


def test_no_detections_may_have_any_empty_form() -> None:
    for empty in (((), ()), ([], []), (np.empty((0, 4)), np.empty(0)), (np.empty((0, 5)), np.empty((0, 1)))):
        assert len(detections(Fixed([empty]))[0]) == 0


def test_boxes_in_the_colour_image_are_scaled_to_an_aligned_thermal_image() -> None:
    double = [tuple(2.0 * edge for edge in box) for box in TWO]
    detector = Fixed([(double, [0.5, 0.5])], camera="colour")
    np.testing.assert_allclose(detections(detector)[0], TWO)
    assert detector.seen[0].shape == (480, 640, 3)


def camera(left_m: float, focal_px: float, size: tuple[int, int]) -> PinholeCalibration:
    middle = [(length - 1) / 2.0 for length in size]
    intrinsics = np.array([[focal_px, 0, middle[0]], [0, focal_px, middle[1]], [0, 0, 1]])
    return PinholeCalibration(
        intrinsics, np.array([[0.0, 0, 1, 0], [-1, 0, 0, left_m], [0, -1, 0, 1.2], [0, 0, 0, 1]])
    )


def standing(calibration: PinholeCalibration) -> Box:
    feet, head = calibration.project(np.array([[5.0, 0.4, 0.0], [5.0, 0.4, 1.72]]))
    height = float(feet[1] - head[1])
    return float(feet[0]) - 0.15 * height, float(head[1]), 0.3 * height, height


def test_boxes_of_calibrated_cameras_are_transferred_by_their_geometry() -> None:
    thermal, colour = camera(0.0, 300.0, (320, 240)), camera(0.3, 620.0, (640, 480))
    frame = replace(next(frames(1)), calibrations={THERMAL: thermal, COLOUR: colour})
    box, _ = detections(Fixed([([standing(colour)], [0.5])], camera="colour"), frame)
    np.testing.assert_allclose(box[0], standing(thermal), atol=0.5)


def test_between_the_images_of_a_slow_camera_nothing_is_missed() -> None:
    every = list(frames(30))
    slow = [f if k % 3 == 0 else replace(f, images={THERMAL: f.images[THERMAL]}) for k, f in enumerate(every)]
    walk = [[tuple(2.0 * edge for edge in box)] for box in WALK[:30:3]]
    detector = Fixed([(boxes, [0.9]) for boxes in walk], camera="colour")
    seen = tracked(detector, slow)
    assert len(detector.seen) == 10
    assert all([track.id for track in tracks] == [1] for tracks in seen[10:])


def test_a_camera_without_images_is_refused_at_once() -> None:
    thermal = [replace(frame, images={THERMAL: frame.images[THERMAL]}) for frame in frames(2)]
    with refused("no image of camera 'colour'", "it has thermal"):
        tracked(Fixed([], camera="colour"), thermal)


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "det.txt"
    path.write_text(text, encoding="utf-8")
    return path


def of_file(path: Path, images: int) -> list[tuple[list[Any], list[Any]]]:
    detector = FileDetector(path)
    found = [detector.detect(np.zeros((240, 320), np.uint8)) for _ in range(images)]
    return [(boxes.tolist(), scores.tolist()) for boxes, scores in found]


def test_a_file_gives_each_image_its_detections_in_any_order(tmp_path: Path) -> None:
    path = written(tmp_path, "3,-1,5,6,7,8,0.5\n1,-1,10,20,30,80,0.75\n1,-1,50,20,30,80,0.25\n")
    assert of_file(path, 4) == [
        ([[10, 20, 30, 80], [50, 20, 30, 80]], [0.75, 0.25]),
        ([], []),
        ([[5, 6, 7, 8]], [0.5]),
        ([], []),
    ]


@pytest.mark.parametrize("line", ["1,-1,10,20,30,80,-1,-1,-1,-1", "1,-1,10,20,30,80", "1,-1,10,20,30,80,-1"])
def test_a_detection_without_a_score_gets_the_probability_of_the_setting(line: str, tmp_path: Path) -> None:
    assert of_file(written(tmp_path, line), 1) == [([[10, 20, 30, 80]], [SCORES.unscored])]


@pytest.mark.parametrize("scale", [lambda x: 100.0 * x, lambda x: x - 3.0, lambda x: 7.0 * x**3])
def test_scores_in_an_unknown_scale_count_by_their_order(
    scale: Callable[[float], float], tmp_path: Path
) -> None:
    lines = [f"{k},-1,10,20,30,80,{scale(float(k))}\n" for k in range(1, 6)]
    probabilities = [scores[0] for _, scores in of_file(written(tmp_path, "".join(lines)), 5)]
    np.testing.assert_allclose(probabilities, [0.1, 0.3, 0.5, 0.7, 0.9])


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("1,-1,10,20,30,80,nan", ("finite", "nan")),
        ("1,-1,10,20,0,80,1", ("above 0", "0.0, 80.0")),
        ("1,-1,10,20,-3,80,1", ("0 or more", "-3")),
        ("0,-1,10,20,30,80,1", ("from 1", "got 0")),
        ("1,-1,10,20,30", ("6 to 10 numbers", "got 5")),
        ("1,-1,10,20,30,eighty,1", ("must be numbers",)),
    ],
)
def test_a_malformed_line_is_refused(line: str, says: tuple[str, ...], tmp_path: Path) -> None:
    path = written(tmp_path, line)
    with refused(f"{path}:1: ", *says):
        FileDetector(path)


def test_boxes_of_other_images_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, "1,-1,1000,600,80,200,1\n2,-1,900,600,80,200,1\n3,-1,10,10,30,80,1\n")
    with refused(str(path), "320 x 240", "67%"):
        of_file(path, 1)


MODULE = """\
class Mine:
    camera = "colour"
    def detect(self, image): return (), ()
class Panoramic(Mine):
    camera = "panorama"
class Deaf:
    pass
class Asking(Mine):
    def __init__(self, weights): pass
"""


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "detector_for_test.py").write_text(MODULE, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("home")
@pytest.mark.parametrize("tracker", WITH_DETECTOR)
def test_a_detector_is_found_by_name_in_the_working_directory(tracker: str) -> None:
    name = f"{tracker}+detector_for_test:Mine"
    assert make_tracker(name).cameras == make_tracker(tracker).cameras
    assert is_own(name)


@pytest.mark.usefixtures("home")
@pytest.mark.parametrize(
    ("name", "says"),
    [
        (
            "contour+detector_for_test:Mine",
            ("'contour' uses no detector", "detection, detection-live, handover, fused"),
        ),
        ("truth+detector_for_test:Mine", ("'truth' uses no detector",)),
        ("a:Tracker+detector_for_test:Mine", ("'a:Tracker' uses no detector",)),
        ("detection+detector_for_test:Deaf", ("detector 'detector_for_test:Deaf'", "`detect(image)`")),
        ("detection+detector_for_test:Asking", ("cannot be made", "without arguments", "weights")),
        ("detection+detector_for_test:Panoramic", ("'thermal' or 'colour'", "'panorama'")),
        ("detection+detector_for_test:Nobody", ("has no 'Nobody'",)),
        ("detection+nowhere_at_all:Mine", ("cannot be imported",)),
        ("detection+hog", ("detector 'hog'", "module:Class", ".txt")),
        ("detection+none.txt", ("none.txt", "No such file")),
    ],
)
def test_what_is_no_detector_is_refused(name: str, says: tuple[str, ...]) -> None:
    with refused(*says):
        make_tracker(name)


class WalkingThenLying:
    """A network that finds one person, who lies from the 20th image on."""

    def __init__(self) -> None:
        self.images = 0

    def detect(self, *_: object) -> NetworkDetections:
        posture = np.zeros((1, len(TrackPosture)))
        posture[0, -1 if self.images >= 20 else 0] = 4.0
        box = np.array([WALK[self.images]])
        self.images += 1
        return NetworkDetections(np.array([5.0]), box, np.array([[-0.2, 0.3]]), posture)


def test_a_network_names_the_postures_of_tracks_and_measures_their_edges() -> None:
    network: Any = WalkingThenLying()
    tracker = PeopleTracker((ThermalSensor(detector=NetworkDetector(network)),))
    grey = np.zeros((240, 320), np.uint8)
    tracks = [tracker.update(Frame(time_s=k / 15.0, images={THERMAL: grey})) for k in range(45)]
    named = [[track.posture for track in one] for one in tracks]
    assert named[19] == [TrackPosture.UPRIGHT]
    assert named[20] == [TrackPosture.UPRIGHT]  # one image is not enough
    assert named[44] == [TrackPosture.LYING]
    assert tracks[44][0].edges == pytest.approx((-0.2, 0.3))


def test_a_trained_network_is_read_from_its_file(tmp_path: Path) -> None:
    weights = {name: np.zeros(shape, np.float32) for name, shape in PeopleNetwork.shapes().items()}
    PeopleNetwork(weights | {"line": np.array([1.0, -9.0], np.float32)}).save(tmp_path / "people.npz")
    name = f"detection+{tmp_path / 'people.npz'}"
    assert not is_own(name)  # its boxes are those of the tracker
    frame = Frame(time_s=0.0, images={THERMAL: np.zeros((96, 128), np.uint8)})
    assert make_tracker(name).update(frame) == ()
    with refused("cannot be read", "peopleboy train people"):
        make_tracker(f"detection+{tmp_path / 'none.npz'}")


def test_a_scenario_runs_with_a_trained_network(tmp_path: Path) -> None:
    weights = {name: np.zeros(shape, np.float32) for name, shape in PeopleNetwork.shapes().items()}
    PeopleNetwork(weights | {"line": np.array([1.0, -9.0], np.float32)}).save(tmp_path / "people.npz")
    assert tracker_cameras(f"detection+{tmp_path / 'people.npz'}") == tracker_cameras("detection")
    with refused("unknown tracker", "nobodys"):
        tracker_cameras("nobodys+people.npz")
