"""Run trackers on drives with a depth camera: the twelve data sets, and the compared trackers."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final

import numpy as np

from peopleboy.random_streams import stream
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.studies.reproductions.experiments.drive_scores import (
    RADIUS_M,
    DriveScore,
    FloorPerson,
    associate,
    people_on_floor,
)
from peopleboy.studies.reproductions.experiments.playback import Moment, Stopwatch, play
from peopleboy.studies.reproductions.plan import shortened
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, LASER, Floats, Frame
from peopleboy.tracker.reproductions.rgbd.rgbd_config import PRINTED, RgbdConfig
from peopleboy.tracker.reproductions.rgbd.rgbd_tracker import RgbdExplanation, RgbdTracker
from peopleboy.tracker.sensors.depth.depth_sensor import DepthExplanation, DepthSensor, DepthSensorConfig
from peopleboy.tracker.sensors.depth.depth_view import DepthView
from peopleboy.tracker.sensors.depth.pre_detection import PRINTED_SIZE
from peopleboy.tracker.sensors.depth.window_model import people_detector, shipped_windows
from peopleboy.tracker.track import Status, Track
from peopleboy.tracker.trackers import Tracker, explanation_of, make_tracker
from peopleboy.tracker.tracking.config import RGBD
from peopleboy.tracker.tracking.people_tracker import PeopleTracker

SETS: Final = (
    "leader_far_ahead",
    "follow_at_distance",
    "corridor_meeting_lights",
    "hall_visits_moving",
    "leader_swap",
    "corridor_pair_passes",
    "crossing_2_moving",
    "hidden_2s_moving",
    "visitors_in_turn",
    "corridor_past_walls",
    "fast_turn_near",
    "group_abreast_moving",
)
"""Scenarios that replace the data sets of the thesis on situation awareness, by number of the set, from 1.

Followers are scripted, so that the tracker cannot change the recording. Light changes in steps; the spots of
ceiling lamps that gave the thesis its false alarms do not exist here.
"""

TURNS: Final = "fast_turn"
"""The scenario with the most rotation of the robot, to measure the benefit of odometry."""

DEFAULT, LITERAL = "default", "as printed"
FILTERS: Final = "particle filters"
CENTIMETRES: Final = "as printed, rows of 1 cm"
ANY_SCORE: Final = "as printed, windows from score 0"
BOTH: Final = "as printed, rows of 1 cm, windows from score 0"
STANDARD: Final = "as printed, OpenCV's far detector"
PRINTED_CHOICES: Final = (LITERAL, CENTIMETRES, ANY_SCORE, BOTH, STANDARD)
"""The tracker as printed, and other readings of what is not printed."""
NO_CONNECTOR, NO_ODOMETRY = "no connector", "no odometry"
NO_WALLS: Final = "walls left in"
NO_DEPTH: Final = "no depth in the filters"
COLOUR_WINDOWS: Final = "windows of colour alone"
OPENCV: Final = "OpenCV's far detector"

_SENSOR: Final = DepthSensorConfig()
SENSORS: Final[Mapping[str, DepthSensorConfig]] = {
    DEFAULT: _SENSOR,
    "printed size": replace(_SENSOR, size=PRINTED_SIZE),
    NO_CONNECTOR: replace(_SENSOR, above=replace(_SENSOR.above, has_connector=False)),
    NO_WALLS: replace(_SENSOR, above=replace(_SENSOR.above, has_walls=False)),
    COLOUR_WINDOWS: _SENSOR,
    OPENCV: _SENSOR,
    NO_ODOMETRY: _SENSOR,
}
"""The depth sensor of the tracker `rgbd`, and variants, by the name used in tables.

One variant's tracker has no odometry; two variants have other classifiers of windows.
"""

PARTICLES: Final = RgbdConfig()
COLOUR_ONLY: Final = replace(PARTICLES, sees_depth=False, least_far_score=0.5, least_near_score=0.2)
"""The least scores of windows that are classified by colour alone."""

FILTERS_CHOICES: Final[Mapping[str, RgbdConfig]] = {
    LITERAL: PRINTED,
    CENTIMETRES: replace(PRINTED, above=replace(PRINTED.above, row_m=0.01)),
    ANY_SCORE: replace(PRINTED, least_far_score=0.0, least_near_score=0.0),
    BOTH: replace(
        PRINTED, above=replace(PRINTED.above, row_m=0.01), least_far_score=0.0, least_near_score=0.0
    ),
    STANDARD: replace(PRINTED, least_far_score=0.0),
    FILTERS: PARTICLES,
    "no verification": replace(PARTICLES, has_verification=False),
    "no sharpening": replace(PARTICLES, filter=replace(PARTICLES.filter, sharpness=0.0)),
    "no hold": replace(PARTICLES, filter=replace(PARTICLES.filter, has_hold=False)),
    "no see-through": replace(PARTICLES, hypotheses=replace(PARTICLES.hypotheses, has_see_through=False)),
    NO_DEPTH: replace(PARTICLES, filter=replace(PARTICLES.filter, kernel_m=1000.0)),
}
"""The thesis's tracker with particle filters, as printed and improved, and variants of both."""

CHOICES: Final = (*SENSORS, *FILTERS_CHOICES)
"""All trackers, by the name used in tables."""

BANDS: Final = (0.1, 0.4, 0.7, 1.0)
"""Upper limits of the hidden share for recall of the pre-detection."""

_HALF: Final = 0.5
_NEAR_M: Final = 0.5


def set_name(number: int) -> str:
    """Return the name of a set in tables."""
    return f"set {number}"


class _WithoutOdometry:
    """A tracker to which the robot seems to stand still."""

    def __init__(self, tracker: Tracker) -> None:
        self._tracker = tracker

    @property
    def cameras(self) -> tuple[str, ...]:
        return self._tracker.cameras

    @property
    def explanation(self) -> object:
        return explanation_of(self._tracker)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        return self._tracker.update(replace(frame, odometry=None))


def make_choice(name: str, rng: np.random.Generator) -> Tracker:
    """Create a tracker, one of `CHOICES`."""
    if name in FILTERS_CHOICES:
        config = FILTERS_CHOICES[name]
        windows = people_detector() if name == STANDARD else shipped_windows(sees_depth=config.sees_depth)
        return RgbdTracker(config, windows, rng)
    model = people_detector() if name == OPENCV else shipped_windows(sees_depth=name != COLOUR_WINDOWS)
    tracker = PeopleTracker((DepthSensor(SENSORS[name], RGBD, model),), RGBD)
    return _WithoutOdometry(tracker) if name == NO_ODOMETRY else tracker


def body_m(name: str) -> float:
    """Return the distance from the visible surface to a tracker's position of a person [m]."""
    if name in FILTERS_CHOICES:
        return FILTERS_CHOICES[name].hypotheses.body_m
    return SENSORS[name].body_m


def play_drive(
    scenario: Scenario, seed: int, further: Sequence[str] = ()
) -> Iterator[tuple[Moment, tuple[FloorPerson, ...]]]:
    """Play a scenario, and yield every image of the depth camera with the people present.

    A depth camera is added to a robot without one; frames also have the images of further cameras.

    Raises:
        BadInput: the robot needs a tracker to drive.
    """
    scenario = scenario.mounting((DEPTH,))
    view = DepthView.of(calibrations_of(scenario.world(seed).robot.cameras)[DEPTH], DEPTH)
    for one in play(scenario, seed, DEPTH, images=(DEPTH, DEPTH_COLOUR, *further)):
        yield one, tuple(people_on_floor(one.truth, view))


class DriveTracking:
    """A tracker of `CHOICES` on a drive, with its score and its time.

    Args:
        name: name of the tracker.
    """

    def __init__(self, name: str) -> None:
        self.tracker = make_choice(name, stream(0, "reproduce.tracker"))
        self.rows: list[tuple[float, ...]] = []
        self._score = DriveScore(body_m(name))
        self._timed = Stopwatch()
        self._found = np.zeros((len(BANDS), 2), np.int64)
        self._false = 0

    def update(self, moment: Moment, people: Sequence[FloorPerson]) -> None:
        """Track one more instant."""
        tracks = self._timed(partial(self.tracker.update, moment.frame))
        tracks = tuple(track for track in tracks if track.status is not Status.TENTATIVE)
        self._score.add(moment.number, people, tracks)
        for track in tracks:
            assert track.place is not None  # this tracker works on the floor
            self.rows.append(_row(moment.number, track.id, track.place.position_m))
        self._count_pre_detections(people)

    def plain(self) -> dict[str, Any]:
        """Return all measurements as plain data; "tracks" has rows of frame, track, position."""
        pre = {"bands": self._found.tolist(), "false": self._false}
        ms = round(self._timed.median_ms, 2)
        return self._score.plain() | {"ms": ms, "pre": pre, "tracks": self.rows}

    def _count_pre_detections(self, people: Sequence[FloorPerson]) -> None:
        """Count people found by size alone, by hidden share, and false detections.

        People cut off by half at the border are omitted, as their visible part has not the size of a person.
        """
        places = _pre_detected(explanation_of(self.tracker))
        found = associate(people, places, _NEAR_M)
        for number, person in enumerate(people):
            if person.is_counted and person.truth.inside_fraction > _HALF:
                band = int(np.searchsorted(BANDS, person.truth.occluded_fraction))
                self._found[band] += (1, number in found)
        self._false += sum(_is_false(place, people) for place in places)


def _pre_detected(explanation: object) -> Floats:
    """Return the positions (N, 2) of objects of human size."""
    if isinstance(explanation, DepthExplanation):
        return explanation.places_m[: len(explanation.layout.detections)]
    assert isinstance(explanation, RgbdExplanation)
    return np.array([one.place_m for one in explanation.detections]).reshape(-1, 2)


def watch_drive(scenario: str, seed: int, names: Sequence[str], scale: float, most_s: float) -> Result:
    """Play a drive once, and run trackers on it.

    Args:
        scenario: name of the scenario.
        seed: seed of the run.
        names: names of trackers in `CHOICES`.
        scale: scale of the depth noise.
        most_s: maximum length [s].

    Returns:
        Plain data: the results of each tracker, by name; "truth", rows of frame, person, position forward and
        left of the robot [m], distance [m], hidden share, whether counted, and "robot", its pose by frame.
    """
    played = shortened(scenario, most_s)
    if scale != 1.0:
        played = played.with_cameras({DEPTH: {"kind": DEPTH, "scale": scale}})
    trackings = {name: DriveTracking(name) for name in names}
    truth: list[tuple[float, ...]] = []
    robot: list[tuple[float, ...]] = []
    for moment, people in play_drive(played, seed):
        for tracking in trackings.values():
            tracking.update(moment, people)
        truth += [_truth_row(moment.number, person) for person in people]
        pose = moment.truth.robot
        robot.append((round(pose.x, 3), round(pose.y, 3), round(pose.heading, 4)))
    return {name: one.plain() for name, one in trackings.items()} | {"truth": truth, "robot": robot}


def watch_legs(scenario: str, most_s: float) -> Result:
    """Track the person of a drive, up to a length [s], by legs in laser scans and by depth and colour.

    Source: SA 4.7.7.

    Returns:
        Plain data: "truth" as in `watch_drive`, and "depth" and "legs", rows of frame, track, position
        forward and left of the robot [m].
    """
    tracking, legs = DriveTracking(DEFAULT), make_tracker(LASER)
    truth: list[tuple[float, ...]] = []
    rows: list[tuple[float, ...]] = []
    for moment, people in play_drive(shortened(scenario, most_s).mounting((LASER,)), 0, further=(LASER,)):
        tracking.update(moment, people)
        found = [one for one in legs.update(moment.frame) if one.status is not Status.TENTATIVE]
        rows += [_row(moment.number, one.id, one.place.position_m) for one in found if one.place is not None]
        truth += [_truth_row(moment.number, person) for person in people]
    return {"truth": truth, "depth": tracking.rows, "legs": rows}


def _truth_row(frame: int, person: FloorPerson) -> tuple[float, ...]:
    """Return frame, person, position, distance, hidden share, and whether the person is counted."""
    distance_m, hidden = round(person.truth.distance_m, 2), round(person.truth.occluded_fraction, 3)
    return (*_row(frame, person.truth.id, person.place_m), distance_m, hidden, int(person.is_counted))


def _row(frame: int, number: int, place_m: tuple[float, float]) -> tuple[float, ...]:
    return (frame, number, *(round(value, 3) for value in place_m))


def _is_false(place: Floats, people: Sequence[FloorPerson]) -> bool:
    return all(np.hypot(*(place - person.place_m)) > RADIUS_M for person in people)
