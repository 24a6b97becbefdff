"""Drive along the middle of corridors: round corners, back from dead ends, past people in the way."""

from __future__ import annotations

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
        sense: whether walls are measured by the sonars, or by the colour image where it shows them.
        camera: the colour camera; only the image needs it.
        cruise_m_s: [m/s] speed along a free corridor.
        pass_m_s: [m/s] speed past people.
        offset_gain: [rad/m] heading towards the lane per metre beside it.
        steepest_rad: [rad] largest such heading.
        heading_gain: [1/s] turn rate per heading error.
        max_turn_rad_s: [rad/s] highest turn rate.
        turn_only_rad: [rad] from this heading error on the robot does not drive.
        believe: share of what was seen that is believed at once.
        lost_s: [s] without sight of walls for this long, the corridor is looked for anew.
        image_s: [s] without a corridor in the image for this long, the mode says that sonars have taken over.
        stop_m: [m] before people in the way the robot stops, from its middle to the echo.
        near_m: [m] the same in a narrow corridor where nobody has been seen for unseen_s: it may be the end.
        narrow_m: [m] width up to which the sides are nearer than the end to all but two sonars when the robot
            stops, so that the end sounds like a person.
        unseen_s: [s] nobody has been seen for this long.
        patience_s: [s] it waits there for them to go on.
        turn_at_m: [m] least distance to a wall ahead at which the robot turns; else half the width.
        brake_gain: [1/s] speed per metre to such a place.
        sure_frames: images in which a side must be open to be taken for a way.
        dead_end_s: [s] before a wall with no way beside it the robot turns back after this long.
        search_rad_s: [rad/s] turn rate where no corridor is recognised.
        wall_tolerance_m: [m] echoes this little before a wall are the wall's.
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
    """What the corridor follower remembers from one step to the next.

    Attributes:
        mode: "corridor", "sonar" (the same, but the image cannot tell), "wait", "pass", "turn", "search" or
            "blind" (no new, sound input).
        reason: why.
        time_s: [s] of the last sound sight.
        corridor: the place in the corridor, or in the one to turn into; None while it is not known.
        seen_s: [s] when walls were last seen by any sense ...
        image_s: [s] ... and when by the image.
        image_fault: why the image could not tell, empty if it could.
        people_s: [s] when anybody was last in the image.
        blocked_s: [s] since when people have been in the middle lane; None if nobody is.
        side: +1 while it passes people on their left, -1 on their right, 0 while it does not.
        ended_s: [s] since when the robot has stood before a wall; None if it does not.
        open_frames: images in which the left and the right side were open, since a wall was heard ahead.
        people: echoes of what is no wall.
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
    """Corridor following as a behaviour: `follow_corridor` with its state kept."""

    following = None

    def __init__(self, config: FollowCorridorConfig | None = None) -> None:
        self._config = FollowCorridorConfig() if config is None else config
        self.state = CorridorState()

    @property
    def mode(self) -> str:
        """What the robot is doing."""
        return self.state.mode

    @property
    def reason(self) -> str:
        """Why it is doing that."""
        return self.state.reason

    def command(self, percept: Percept) -> Command:
        """Return the command for this sight."""
        self.state, command = follow_corridor(self.state, percept, self._config)
        return command


def follow_corridor(
    state: CorridorState, percept: Percept, config: FollowCorridorConfig
) -> tuple[CorridorState, Command]:
    """Take one step along the corridor.

    The robot stops on senseless input or when time stands still.

    Source: thesis, section 3.2, names corridor following from sonar readings and says no more; the rest is
    ours.
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
    """Move the place by the wheels, and correct it by what is seen of the walls."""
    expected = state.corridor if percept.time_s - state.seen_s <= config.lost_s else None
    if expected is not None:
        expected = drive_on(expected, RobotMotion.of(percept, step_s))
        if abs(expected.heading_rad) > config.turn_only_rad:  # turning: the walls are yet to come into view
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
    """Keep the echoes that no wall explains."""
    walls = side_walls(corridor)
    if ahead_m is not None:
        walls = np.concatenate([walls, [(-corridor.heading_rad, ahead_m)]])
    others = without_walls(percept, walls, config.wall_tolerance_m, config.sonar.beam)
    # A range beyond reach lies outside of what is remembered.
    heard = replace(percept, sonar_m=np.minimum(others, 2.0 * config.sonar.beam.reach_m))
    return remember(state.people, heard, config.memory)


def _look_aside(
    state: CorridorState, corridor: Corridor, percept: Percept, ahead_m: float, config: FollowCorridorConfig
) -> CorridorState:
    """Count the images in which the sides are open, near the wall ahead."""
    if ahead_m > 0.8 * corridor.width_m:
        return state
    room = open_room(percept, corridor, config.end)
    left, right = (count + (metres > 0.0) for count, metres in zip(state.open_frames, room, strict=True))
    return replace(state, open_frames=(left, right))


def _turning_place(corridor: Corridor, config: FollowCorridorConfig) -> float:
    """Give the distance [m] to the wall ahead at which to turn: the middle of a corner as wide as the way."""
    return max(corridor.width_m / 2.0, config.turn_at_m)


def _end(
    state: CorridorState, corridor: Corridor, percept: Percept, ahead_m: float, config: FollowCorridorConfig
) -> tuple[CorridorState, Command]:
    """Before a wall: turn to an open side, the roomier of two, or turn back."""
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
    """Drive in the middle, or wait for people who stand there, and at last drive past them."""
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
        state = replace(state, mode="pass", reason="somebody stays in the way", side=side)
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
    """Stop before who is in the way; in a narrow corridor go on slowly to what nobody was seen at."""
    is_unseen = state.time_s - state.people_s > config.unseen_s
    if is_unseen and not is_free and corridor.width_m < config.narrow_m:
        reason = "something unseen is across the way"
        stop_m, fastest_m_s = config.near_m, config.pass_m_s
    else:
        reason = "somebody is in the way" if is_free else "people stand across the way"
        stop_m, fastest_m_s = config.stop_m, config.cruise_m_s
    speed = min(config.brake_gain * max(nearest_m - stop_m, 0.0), fastest_m_s)
    here = Lane(offset_m=corridor.offset_m, clearance_m=0.0)
    state = replace(state, mode="wait", reason=reason, side=0)
    return state, _steer(corridor, here, speed, ahead_m, config)


def _driving(state: CorridorState, config: FollowCorridorConfig) -> CorridorState:
    """Name mode and reason of plain driving, by the sense that steers it."""
    state = replace(state, blocked_s=None, side=0)
    if config.sense == "image" and state.time_s - state.image_s > config.image_s:
        reason = f"the image does not tell: {state.image_fault}"
        return replace(state, mode="sonar", reason=reason)
    return replace(state, mode="corridor", reason=f"walls told by the {config.sense}")


def _steer(
    corridor: Corridor, lane: Lane, speed_m_s: float, ahead_m: float | None, config: FollowCorridorConfig
) -> Command:
    """Head for the lane, slower the more the robot must turn, and before a wall."""
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
