"""Corridor following: drive in the middle, turn at corners and dead ends, and pass people."""

import math
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from peopleboy.behaviours.behaviour import STOP, Command
from peopleboy.behaviours.corridor.corridor_from_image import (
    CorridorCamera,
    ImageCorridorConfig,
    corridor_from_image,
)
from peopleboy.behaviours.corridor.corridor_from_sonar import (
    EndConfig,
    SonarCorridorConfig,
    corridor_from_sonar,
    open_room,
    side_walls,
    wall_ahead,
    without_walls,
)
from peopleboy.behaviours.corridor.corridor_geometry import (
    Corridor,
    Lane,
    LaneConfig,
    Unknown,
    beside,
    best_lane,
    blend,
    drive_on,
    in_corridor,
    middle_lane,
)
from peopleboy.behaviours.dead_reckoning import RobotMotion
from peopleboy.behaviours.percept import Percept
from peopleboy.behaviours.sonar_echoes import EchoMemory, EchoMemoryConfig, remember

Sense = Literal["sonar", "image"]


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowCorridorConfig:
    """Gains and limits of corridor following.

    Attributes:
        sense: sensor for measuring walls: the sonars, or the colour image with the sonars as a fallback.
        camera: the colour camera; only used with the image.
        cruise_m_s: [m/s] speed along a free corridor.
        pass_m_s: [m/s] speed past people.
        offset_gain: [rad/m] heading correction per lateral error.
        steepest_rad: [rad] largest heading correction.
        heading_gain: [1/s] turn rate per heading error.
        max_turn_rad_s: [rad/s] highest turn rate.
        turn_only_rad: [rad] heading error from which on the robot only turns.
        believe: weight of a measurement in the correction.
        lost_s: [s] time without walls after which the robot searches for the corridor again.
        image_s: [s] time without a corridor in the image after which the mode is "sonar".
        stop_m: [m] distance from the robot's centre to a person's echo at which it stops.
        near_m: [m] the same in a narrow corridor without a visible person for unseen_s, where the echo may be
            the end.
        narrow_m: [m] width up to which all sonars except two measure the sides nearer than the end when the
            robot stops, so that the end resembles a person.
        unseen_s: [s] time without a person in the image.
        patience_s: [s] waiting time for people to move on.
        turn_at_m: [m] least distance to a wall ahead at which the robot turns; otherwise half the width.
        brake_gain: [1/s] speed per distance to the turning point.
        sure_frames: number of images in which a side must be open to count as an opening.
        dead_end_s: [s] time after which the robot turns back at a wall without an opening.
        search_rad_s: [rad/s] turn rate without a recognised corridor.
        wall_tolerance_m: [m] echoes within this distance in front of a wall belong to it.
    """

    sense: Sense = "sonar"
    camera: CorridorCamera | None = None
    cruise_m_s: float = 0.6
    pass_m_s: float = 0.35
    offset_gain: float = 1.0
    steepest_rad: float = math.radians(30.0)
    heading_gain: float = 1.8
    max_turn_rad_s: float = 0.9
    turn_only_rad: float = math.radians(40.0)
    believe: float = 0.25
    lost_s: float = 8.0
    image_s: float = 0.5
    stop_m: float = 1.5
    near_m: float = 0.7
    narrow_m: float = 2.3
    unseen_s: float = 2.0
    patience_s: float = 4.0
    turn_at_m: float = 0.8
    brake_gain: float = 0.8
    sure_frames: int = 5
    dead_end_s: float = 1.0
    search_rad_s: float = 0.4
    wall_tolerance_m: float = 0.3
    sonar: SonarCorridorConfig = field(default_factory=SonarCorridorConfig)
    image: ImageCorridorConfig = field(default_factory=ImageCorridorConfig)
    end: EndConfig = field(default_factory=EndConfig)
    lane: LaneConfig = field(default_factory=LaneConfig)
    memory: EchoMemoryConfig = field(default_factory=lambda: EchoMemoryConfig(keep_s=1.5, within_m=2.6))


@dataclass(frozen=True, slots=True, kw_only=True)
class CorridorState:
    """State of the corridor follower between steps.

    Attributes:
        mode: "corridor", "sonar" (the same without usable image), "wait", "pass", "turn", "search" or "blind"
            (no new, valid input).
        reason: reason for the mode.
        time_s: [s] time of the last valid percept.
        corridor: pose in the corridor, or in the one to turn into; None while unknown.
        seen_s: [s] time of the last measurement of walls by any sensor ...
        image_s: [s] ... and by the image.
        image_fault: why the image was unusable; empty if it was usable.
        people_s: [s] time when a person was last in the image.
        blocked_s: [s] time from which people have been in the middle lane; None without people.
        side: +1 while the robot passes people on their left, -1 on their right, 0 otherwise.
        ended_s: [s] time from which the robot has been at a wall; None otherwise.
        open_frames: numbers of images with an open left and right side, since a wall was measured ahead.
        people: echoes that do not belong to walls.
    """

    mode: str = "search"
    reason: str = "start"
    time_s: float = -math.inf
    corridor: Corridor | None = None
    seen_s: float = -math.inf
    image_s: float = -math.inf
    image_fault: str = ""
    people_s: float = -math.inf
    blocked_s: float | None = None
    side: int = 0
    ended_s: float | None = None
    open_frames: tuple[int, int] = (0, 0)
    people: EchoMemory = field(default_factory=EchoMemory)


class FollowCorridor:
    """Corridor following as a behaviour: `follow_corridor` with stored state."""

    following = None

    def __init__(self, config: FollowCorridorConfig | None = None) -> None:
        self._config = FollowCorridorConfig() if config is None else config
        self.state = CorridorState()

    @property
    def mode(self) -> str:
        """Current activity."""
        return self.state.mode

    @property
    def reason(self) -> str:
        """Reason for the mode."""
        return self.state.reason

    def command(self, percept: Percept) -> Command:
        """Return the command for a percept."""
        self.state, command = follow_corridor(self.state, percept, self._config)
        return command


def follow_corridor(
    state: CorridorState, percept: Percept, config: FollowCorridorConfig
) -> tuple[CorridorState, Command]:
    """Return the state and command of one step of corridor following.

    The robot stops on invalid input or when time does not increase.

    Source: thesis, section 3.2, mentions corridor following from sonar readings, without details.
    """
    step_s = percept.time_s - state.time_s
    if not (percept.is_sound and step_s > 0.0):
        return replace(state, mode="blind", reason="no new input"), STOP
    people_s = percept.time_s if percept.people else state.people_s
    state = replace(_locate(state, percept, step_s, config), time_s=percept.time_s, people_s=people_s)
    corridor = state.corridor
    if corridor is None:
        turning = Command(linear_m_s=0.0, angular_rad_s=config.search_rad_s)
        return replace(state, mode="search"), turning
    if abs(corridor.heading_rad) > config.turn_only_rad:
        return replace(state, mode="turn"), _turn(corridor, config)
    ahead_m = wall_ahead(percept, corridor, config.end)
    state = replace(state, people=_remember_people(state, corridor, percept, ahead_m, config))
    if ahead_m is None:
        state = replace(state, open_frames=(0, 0), ended_s=None)
    else:
        state = _look_aside(state, corridor, percept, ahead_m, config)
        if ahead_m < _turning_place(corridor, config):
            return _end(state, corridor, percept, ahead_m, config)
    return _go_along(state, corridor, ahead_m, config)


def _locate(
    state: CorridorState, percept: Percept, step_s: float, config: FollowCorridorConfig
) -> CorridorState:
    """Predict the pose by wheel odometry, and correct it by the measured walls."""
    expected = state.corridor if percept.time_s - state.seen_s <= config.lost_s else None
    if expected is not None:
        expected = drive_on(expected, RobotMotion.of(percept, step_s))
        if abs(expected.heading_rad) > config.turn_only_rad:  # turning: the walls are not visible yet
            return replace(state, corridor=expected, seen_s=percept.time_s)
    by_image: Corridor | Unknown = Unknown("")
    if config.sense == "image" and config.camera is not None:
        by_image = corridor_from_image(percept.images.get("colour"), config.camera, expected, config.image)
    is_by_image = isinstance(by_image, Corridor)
    seen = by_image if is_by_image else corridor_from_sonar(percept, expected, config.sonar)
    state = replace(
        state,
        image_s=percept.time_s if is_by_image else state.image_s,
        image_fault=by_image.reason if isinstance(by_image, Unknown) else "",
    )
    if isinstance(seen, Unknown):
        return replace(state, corridor=expected, reason=seen.reason if expected is None else state.reason)
    place = seen if expected is None else blend(expected, seen, config.believe)
    return replace(state, corridor=place, seen_s=percept.time_s)


def _remember_people(
    state: CorridorState,
    corridor: Corridor,
    percept: Percept,
    ahead_m: float | None,
    config: FollowCorridorConfig,
) -> EchoMemory:
    """Return the echoes that do not belong to walls."""
    walls = side_walls(corridor)
    if ahead_m is not None:
        walls = np.concatenate([walls, [(-corridor.heading_rad, ahead_m)]])
    others = without_walls(percept, walls, config.wall_tolerance_m, config.sonar.beam)
    # Ranges at full scale are outside the range of the memory.
    heard = replace(percept, sonar_m=np.minimum(others, 2.0 * config.sonar.beam.reach_m))
    return remember(state.people, heard, config.memory)


def _look_aside(
    state: CorridorState, corridor: Corridor, percept: Percept, ahead_m: float, config: FollowCorridorConfig
) -> CorridorState:
    """Count the images with open sides near the wall ahead."""
    if ahead_m > 0.8 * corridor.width_m:
        return state
    room = open_room(percept, corridor, config.end)
    left, right = (count + (metres > 0.0) for count, metres in zip(state.open_frames, room, strict=True))
    return replace(state, open_frames=(left, right))


def _turning_place(corridor: Corridor, config: FollowCorridorConfig) -> float:
    """Return the distance [m] to the wall ahead at which to turn, for a corner as wide as the corridor."""
    return max(corridor.width_m / 2.0, config.turn_at_m)


def _end(
    state: CorridorState, corridor: Corridor, percept: Percept, ahead_m: float, config: FollowCorridorConfig
) -> tuple[CorridorState, Command]:
    """Turn at a wall to the wider open side, or turn back."""
    since_s = percept.time_s if state.ended_s is None else state.ended_s
    is_open = [count >= config.sure_frames for count in state.open_frames]
    room = open_room(percept, corridor, config.end)
    state = replace(state, ended_s=since_s, mode="turn")
    beyond = (
        ahead_m - corridor.width_m / 2.0
    )  # before the middle of the corner, where the new centre line runs
    if any(is_open):
        side = (1 if room[0] >= room[1] else -1) if all(is_open) else (1 if is_open[0] else -1)
        reason = f"wall ahead, open to the {'left' if side > 0 else 'right'}"
        turned = replace(
            corridor, offset_m=side * beyond, heading_rad=corridor.heading_rad - side * math.pi / 2.0
        )
    elif percept.time_s - since_s > config.dead_end_s:
        reason = "dead end"
        turned = replace(corridor, offset_m=-corridor.offset_m, heading_rad=corridor.heading_rad - math.pi)
    else:
        return replace(state, reason="wall ahead"), STOP
    state = replace(state, corridor=turned, reason=reason, people=EchoMemory(), blocked_s=None)
    return replace(state, open_frames=(0, 0), ended_s=None), STOP


def _turn(corridor: Corridor, config: FollowCorridorConfig) -> Command:
    """Turn on the spot into the corridor."""
    turn = -math.copysign(config.max_turn_rad_s, corridor.heading_rad)
    return Command(linear_m_s=0.0, angular_rad_s=turn)


def _go_along(
    state: CorridorState, corridor: Corridor, ahead_m: float | None, config: FollowCorridorConfig
) -> tuple[CorridorState, Command]:
    """Drive in the middle, wait for people there, and pass them if they stay."""
    people = beside(in_corridor(state.people.points, corridor), corridor, config.lane)
    ahead = people[people[:, 0] > 0.0]
    if middle_lane(ahead).clearance_m >= config.lane.least_m:
        lane = best_lane(people, corridor, config.lane)
        return _driving(state, config), _steer(corridor, lane, config.cruise_m_s, ahead_m, config)
    since_s = state.time_s if state.blocked_s is None else state.blocked_s
    state = replace(state, blocked_s=since_s)
    lane = best_lane(people, corridor, config.lane, state.side)
    is_free = lane.clearance_m >= (config.lane.squeeze_m if state.side else config.lane.least_m)
    if is_free and (state.side or state.time_s - since_s > config.patience_s):
        side = state.side or (1 if lane.offset_m > 0.0 else -1)
        state = replace(state, mode="pass", reason="passing a person who stays in the way", side=side)
        return state, _steer(corridor, lane, config.pass_m_s, ahead_m, config)
    return _wait(state, corridor, float(np.min(ahead[:, 0])), ahead_m, is_free, config)


def _wait(
    state: CorridorState,
    corridor: Corridor,
    nearest_m: float,
    ahead_m: float | None,
    is_free: bool,
    config: FollowCorridorConfig,
) -> tuple[CorridorState, Command]:
    """Stop in front of people; in a narrow corridor approach an echo without a visible person slowly."""
    is_unseen = state.time_s - state.people_s > config.unseen_s
    if is_unseen and not is_free and corridor.width_m < config.narrow_m:
        reason = "an obstacle blocks the corridor, without a visible person"
        stop_m, fastest_m_s = config.near_m, config.pass_m_s
    else:
        reason = "a person is in the way" if is_free else "people block the corridor"
        stop_m, fastest_m_s = config.stop_m, config.cruise_m_s
    speed = min(config.brake_gain * max(nearest_m - stop_m, 0.0), fastest_m_s)
    here = Lane(offset_m=corridor.offset_m, clearance_m=0.0)
    state = replace(state, mode="wait", reason=reason, side=0)
    return state, _steer(corridor, here, speed, ahead_m, config)


def _driving(state: CorridorState, config: FollowCorridorConfig) -> CorridorState:
    """Return mode and reason of normal driving, by the active sensor."""
    state = replace(state, blocked_s=None, side=0)
    if config.sense == "image" and state.time_s - state.image_s > config.image_s:
        reason = f"no corridor in the image: {state.image_fault}"
        return replace(state, mode="sonar", reason=reason)
    return replace(state, mode="corridor", reason=f"walls measured by {config.sense}")


def _steer(
    corridor: Corridor, lane: Lane, speed_m_s: float, ahead_m: float | None, config: FollowCorridorConfig
) -> Command:
    """Steer to the lane; slow down in turns, and in front of a wall."""
    beside_m = lane.offset_m - corridor.offset_m
    heading = _clip(config.offset_gain * beside_m, config.steepest_rad)
    error = heading - corridor.heading_rad
    speed = speed_m_s * max(1.0 - abs(error) / config.turn_only_rad, 0.0)
    if ahead_m is not None:
        to_go = ahead_m - _turning_place(corridor, config)
        speed = min(speed, config.brake_gain * max(to_go, 0.0) + 0.1)
    turn = _clip(config.heading_gain * error, config.max_turn_rad_s)
    return Command(linear_m_s=speed, angular_rad_s=turn)


def _clip(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
