"""Letting trackers watch a drive, all of them the same images, and scoring what they say."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.sim.random_streams import stream
from peopleboy.studies.reproductions.evaluations.drive_scores import RADIUS_M, DriveScore, match
from peopleboy.studies.reproductions.evaluations.leg_tracker import CAMERAS, LegTracker, scan
from peopleboy.studies.reproductions.evaluations.playback import (
    DriveMoment,
    Stander,
    play_drive,
    with_cameras,
)
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.rgbd.pre_detection import PRINTED_SIZE
from peopleboy.tracker.rgbd.rgbd_config import PRINTED, RgbdConfig
from peopleboy.tracker.rgbd.rgbd_tracker import RgbdTracker
from peopleboy.tracker.rgbd.verification.window_model import people_detector, shipped_windows
from peopleboy.tracker.track import Status, Track

# The RGB-D tracker, and the same with one thing left out or done otherwise.

OURS: Final = RgbdConfig()
DEFAULT, LITERAL = "default", "as printed"
NO_CONNECTOR, NO_ODOMETRY = "no connector", "no odometry"
NO_WALLS: Final = "walls left in"
NO_DEPTH: Final = "no depth in the filters"
OPENCV: Final = "OpenCV's far detector"
COLOUR_ONLY: Final = replace(
    OURS,
    sees_depth=False,
    least_far_score=0.5,
    least_near_score=0.2,
    hypotheses=replace(OURS.hypotheses, births=2),
)
"""Judges windows by colour alone, which needs a second look."""

CHOICES: Final[Mapping[str, RgbdConfig]] = {
    DEFAULT: OURS,
    LITERAL: PRINTED,
    "printed size": replace(OURS, size=PRINTED_SIZE),
    NO_CONNECTOR: replace(OURS, above=replace(OURS.above, has_connector=False)),
    NO_WALLS: replace(OURS, above=replace(OURS.above, has_walls=False)),
    "windows of colour alone": COLOUR_ONLY,
    "no verification": replace(OURS, has_verification=False),
    OPENCV: COLOUR_ONLY,
    "no sharpening": replace(OURS, filter=replace(OURS.filter, sharpness=0.0)),
    "no hold": replace(OURS, filter=replace(OURS.filter, has_hold=False)),
    "no see-through": replace(OURS, hypotheses=replace(OURS.hypotheses, has_see_through=False)),
    NO_DEPTH: replace(OURS, filter=replace(OURS.filter, kernel_m=1000.0)),
    NO_ODOMETRY: replace(OURS, hypotheses=replace(OURS.hypotheses, uses_odometry=False)),
}
"""By the name that tables have for them."""


def make_choice(name: str, rng: np.random.Generator) -> RgbdTracker:
    """Make one of `CHOICES`."""
    config = CHOICES[name]
    model = people_detector() if name == OPENCV else shipped_windows(sees_depth=config.sees_depth)
    return RgbdTracker(config, model, rng)


BANDS: Final = (0.1, 0.4, 0.7, 1.0)
"""Shares of somebody that others hide, up to which recall of the pre-detection is told."""

_HALF: Final = 0.5
_NEAR_M: Final = 0.5


class Watcher:
    """One tracker, its score, and how long it takes.

    Args:
        name: one of `CHOICES`.
    """

    def __init__(self, name: str) -> None:
        self.tracker: RgbdTracker = make_choice(name, stream(0, "reproduce.tracker"))
        self._score = DriveScore(CHOICES[name].hypotheses.body_m)
        self._times_ms: list[float] = []
        self._found = np.zeros((len(BANDS), 2), np.int64)
        self._false = 0
        self._told: list[tuple[float, ...]] = []

    def see(self, moment: DriveMoment) -> None:
        """Take in an instant."""
        start = time.process_time()
        said = self.tracker.update(moment.frame)
        self._times_ms.append(1000.0 * (time.process_time() - start))
        tracks = tuple(track for track in said if track.status is not Status.TENTATIVE)
        self._score.add(moment.number, moment.people, tracks)
        self._told += [_told(moment.number, track) for track in tracks]
        self._count_pre_detections(moment.people)

    def plain(self) -> dict[str, Any]:
        """Give all that was measured as plain data; "told" has rows of frame, track, place."""
        pre = {"bands": self._found.tolist(), "false": self._false}
        ms = round(float(np.median(self._times_ms)), 2)
        return self._score.plain() | {"ms": ms, "pre": pre, "told": self._told}

    def _count_pre_detections(self, people: Sequence[Stander]) -> None:
        """Count who is found by size alone, by how much of them is hidden, and what is nobody.

        Of whom the border cuts off half has not the size of a human.
        """
        explanation = self.tracker.explanation
        assert explanation is not None  # it has seen a frame
        places = np.array([one.place_m for one in explanation.detections]).reshape(-1, 2)
        found = match(people, places, _NEAR_M)
        for number, person in enumerate(people):
            if person.is_counted and person.inside > _HALF:
                self._found[int(np.searchsorted(BANDS, person.hidden))] += (1, number in found)
        self._false += sum(_is_nobody(place, people) for place in places)


def watch_drive(scenario: Scenario, seed: int, names: Iterable[str]) -> dict[str, Any]:
    """Play a drive once, and let trackers watch it.

    Returns:
        Plain data: what each tracker did, by its name; "truth", rows of frame, person, place forward and left
        of the robot [m], distance [m], hidden share, whether it counts, and "robot", its pose by frame.
    """
    watchers = {name: Watcher(name) for name in names}
    truth: list[tuple[float, ...]] = []
    robot: list[tuple[float, ...]] = []
    for moment in play_drive(scenario, seed):
        for watcher in watchers.values():
            watcher.see(moment)
        truth += [truth_row(moment.number, person) for person in moment.people]
        pose = moment.robot
        robot.append((round(pose.x, 3), round(pose.y, 3), round(pose.heading, 4)))
    return {name: watcher.plain() for name, watcher in watchers.items()} | {
        "truth": truth,
        "robot": robot,
    }


def truth_row(frame: int, person: Stander) -> tuple[float, ...]:
    """Give frame, person, place, distance, hidden share, and whether somebody counts."""
    x, y = person.place_m
    shares = round(x, 3), round(y, 3), round(person.distance_m, 2), round(person.hidden, 3)
    return (frame, person.id, *shares, int(person.is_counted))


def _told(frame: int, track: Track) -> tuple[float, ...]:
    assert track.place is not None  # this tracker works on the floor
    return (frame, track.id, *(round(value, 3) for value in track.place.position_m))


def _is_nobody(place: Floats, people: Sequence[Stander]) -> bool:
    return all(np.hypot(*(place - person.place_m)) > RADIUS_M for person in people)


# The twelve data sets of the thesis on situation awareness, and the scenarios that stand for them.

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
"""Scenarios by the set's number, from 1.

Followers are scripted, so that what a tracker does cannot change the film. Light changes in steps; the spots
of ceiling lamps that gave the thesis its false alarms do not exist here.
"""

TURNS: Final = "fast_turn"
"""Where the robot turns most, for what odometry is worth."""


def set_name(number: int) -> str:
    """Name a set as tables do."""
    return f"set {number}"


# Following one person by legs and by depth and colour at the same time (SA 4.7.7).


def watch_legs(scenario: Scenario, seed: int) -> dict[str, Any]:
    """Play a drive with a laser's stand-in near the floor.

    Returns:
        Plain data: "truth" as of `watch_drive`, and "depth" and "legs", rows of frame, track, place forward
        and left of the robot [m].
    """
    watcher, legs = Watcher(DEFAULT), LegTracker()
    truth: list[tuple[float, ...]] = []
    told: list[tuple[float, ...]] = []
    for moment in play_drive(with_cameras(scenario, CAMERAS), seed):
        watcher.see(moment)
        tracks = legs.update(scan(moment.observation), moment.frame.odometry)
        told += [(moment.number, one.id, *(round(value, 3) for value in one.place_m)) for one in tracks]
        truth += [truth_row(moment.number, person) for person in moment.people]
    return {"truth": truth, "depth": watcher.plain()["told"], "legs": told}
