"""Find a person, go near, keep the distance: all from the person's place and height in the image."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from behaviours.avoid import AvoidConfig, swerve
from behaviours.command import STOP, Command
from behaviours.echoes import echoes
from behaviours.sight import SeenPerson, Sight
from behaviours.target import Target, TargetConfig, carry_on, first_sight, forget_drift, look_again


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowConfig:
    """Gains and limits of the person-following law.

    Speeds are set by the distance error keep_height / height - 1: 0 where the person should be, 1 at twice
    that distance, whatever the person's size in metres.

    Attributes:
        keep_height: [image heights] apparent height to hold; 0.58 is 3.7 m for a person of 1.75 m. A level
            camera at 1.2 m shows people whole from 3 m on; the rest is for those who turn back.
        stop_height: [image heights] from here on the robot does not drive forwards.
        near_height: [image heights] from here on the robot backs off.
        approach_gain: [m/s] forward speed per distance error.
        learn_gain: [m/s2] rate per distance error at which the person's walking speed is learnt.
        back_off_gain: [m/s] backward speed per share of height beyond near_height.
        back_off_m_s: [m/s] highest backward speed.
        max_linear_m_s: [m/s] highest forward speed.
        facing_gain: [1/s] turn rate per bearing.
        drift_share: share of the person's own angular speed that the robot turns along.
        max_turn_rad_s: [rad/s] highest turn rate; faster turns blur the thermal image.
        full_speed_rad: [rad] up to this bearing the robot drives at full speed ...
        turn_only_rad: [rad] ... and from this one on it only turns.
        swerve_from_m_s: [m/s] forward speed from which the robot swerves fully past obstacles.
        search_rad_s: [rad/s] turn rate while nobody is seen.
        stalled_s: [s] a search that does not turn for this long goes on the other way round.
        wait_turn_rad_s: [rad/s] highest turn rate while waiting for a lost person.
        max_age_s: [s] an older track stops the robot.
        wait_s: [s] from the last sight of a person who left the image until the search begins.
        patience_s: [s] the same for one lost in the middle of the image: hidden, or missed by the tracker.
        leaving_rad: [rad] a person seen farther off the nose, or about to be, has left the image.
        min_confidence: people of lower confidence are not followed.
        target: smoothing of what is seen.
        avoid: steering along walls.
    """

    keep_height: float = 0.58
    stop_height: float = 0.74
    near_height: float = 0.88
    approach_gain: float = 2.5
    learn_gain: float = 0.5
    back_off_gain: float = 1.0
    back_off_m_s: float = 0.25
    max_linear_m_s: float = 0.8
    facing_gain: float = 2.0
    drift_share: float = 0.8
    max_turn_rad_s: float = 1.2
    full_speed_rad: float = math.radians(9.0)
    turn_only_rad: float = math.radians(32.0)
    swerve_from_m_s: float = 0.1
    search_rad_s: float = 0.6
    stalled_s: float = 0.7
    wait_turn_rad_s: float = 0.5
    max_age_s: float = 0.3
    wait_s: float = 1.2
    patience_s: float = 3.0
    leaving_rad: float = math.radians(19.0)
    min_confidence: float = 0.5
    target: TargetConfig = field(default_factory=TargetConfig)
    avoid: AvoidConfig = field(default_factory=AvoidConfig)


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowState:
    """What the follower remembers from one step to the next.

    Attributes:
        mode: "search", "follow", "wait" (just lost the person) or "blind" (no new, sound input).
        time_s: [s] of the last sound sight.
        target: the followed person, None while searching.
        walking_m_s: [m/s] learnt speed at which the person walks away.
        side: +1 (left) or -1, to which to search: where the person was last seen to go.
        patience_s: [s] how long to wait for the person before searching.
        stalled_s: [s] for how long the search has not turned: an obstacle is in the way.
    """

    mode: str = "search"
    time_s: float = -math.inf
    target: Target | None = None
    walking_m_s: float = 0.0
    side: int = 1
    patience_s: float = 0.0
    stalled_s: float = 0.0


class FollowPerson:
    """Person following as a behaviour: `follow` with its state kept."""

    def __init__(self, config: FollowConfig | None = None) -> None:
        self._config = FollowConfig() if config is None else config
        self.state = FollowState()

    @property
    def mode(self) -> str:
        """What the robot is doing."""
        return self.state.mode

    def command(self, sight: Sight) -> Command:
        """Give the command for this sight."""
        self.state, command = follow(self.state, sight, self._config)
        return command


def follow(state: FollowState, sight: Sight, config: FollowConfig) -> tuple[FollowState, Command]:
    """Take one step of searching, following or waiting.

    The robot drives only while the person's track is younger than max_age_s, and stops on senseless
    input or when time stands still.

    Source: thesis, section 3.2: search by rotating, approach, hold distance; the learnt walking speed,
    the drift and the wait are ours.
    """
    step_s = sight.time_s - state.time_s
    if not (sight.is_sound and step_s > 0.0):
        return replace(state, mode="blind"), STOP
    state = replace(_update_target(state, sight, step_s, config), time_s=sight.time_s)
    if state.target is None:
        return _search(state, sight, step_s, config)
    if sight.time_s - state.target.seen_s > config.max_age_s:
        return _wait(state, state.target, config)
    return _go_after(state, state.target, sight, step_s, config)


def distance_error(height: float, config: FollowConfig) -> float:
    """Give how much too far the person is, as a share of the distance to keep; below 0 is too near."""
    return config.keep_height / height - 1.0


def choose(people: tuple[SeenPerson, ...], target: Target | None, config: FollowConfig) -> SeenPerson | None:
    """Choose whom to follow: the same person as before, else whoever seems nearest (tallest).

    A person who is still tracked, though hidden just now, is not exchanged for another.
    """
    if target is not None and any(person.id == target.id for person in people):
        people = tuple(person for person in people if person.id == target.id)
    seen = [
        person
        for person in people
        if person.is_sound and person.is_visible and person.confidence >= config.min_confidence
    ]
    return max(seen, key=lambda person: person.height, default=None)


def _update_target(state: FollowState, sight: Sight, step_s: float, config: FollowConfig) -> FollowState:
    """Predict where the followed person is, look for it, forget it when it stays away."""
    known = state.target if step_s <= config.wait_s else None
    person = choose(sight.people, known, config)
    if person is not None:
        if known is None:
            seen = first_sight(person, sight.time_s, config.target)
        else:
            moved = carry_on(known, sight.angular_rad_s, step_s)
            seen = look_again(moved, person, sight.time_s, step_s, config.target)
        return replace(state, target=seen, side=_side(seen, config), patience_s=_patience(seen, config))
    if known is None or sight.time_s - known.seen_s > state.patience_s:
        return replace(state, target=None)
    moved = carry_on(known, sight.angular_rad_s, step_s)
    return replace(state, target=forget_drift(moved, step_s, config.target))


def _side(target: Target, config: FollowConfig) -> int:
    """Tell on which side the person will be when the search begins: +1 left, -1 right."""
    return 1 if target.bearing_rad + target.drift_rad_s * config.wait_s >= 0.0 else -1


def _patience(target: Target, config: FollowConfig) -> float:
    """Tell how long [s] to wait for the person, should this be the last sight."""
    soon = target.bearing_rad + target.drift_rad_s * config.max_age_s
    return (
        config.wait_s if max(abs(target.bearing_rad), abs(soon)) > config.leaving_rad else config.patience_s
    )


def _search(
    state: FollowState, sight: Sight, step_s: float, config: FollowConfig
) -> tuple[FollowState, Command]:
    """Rotate in place, to the side where the person was last seen; if that is blocked, to the other."""
    is_stalled = state.mode == "search" and abs(sight.angular_rad_s) < 0.1 * config.search_rad_s
    stalled_s = state.stalled_s + min(step_s, config.max_age_s) if is_stalled else 0.0
    if stalled_s > config.stalled_s:
        state, stalled_s = replace(state, side=-state.side), 0.0
    turn = state.side * config.search_rad_s
    state = replace(state, mode="search", walking_m_s=0.0, stalled_s=stalled_s)
    return state, Command(linear_m_s=0.0, angular_rad_s=turn)


def _wait(state: FollowState, target: Target, config: FollowConfig) -> tuple[FollowState, Command]:
    """Stand, and turn gently towards where the person should be by now."""
    turn = _clip(_facing_turn(target, config), config.wait_turn_rad_s)
    return replace(state, mode="wait", walking_m_s=0.0), Command(linear_m_s=0.0, angular_rad_s=turn)


def _go_after(
    state: FollowState, target: Target, sight: Sight, step_s: float, config: FollowConfig
) -> tuple[FollowState, Command]:
    """Turn towards the person and close the distance."""
    walking = _learn_walking(state.walking_m_s, target, sight, step_s, config)
    speed = _speed(target, walking, config)
    turn = _clip(_turn(target, speed, sight, config), config.max_turn_rad_s)
    state = replace(state, mode="follow", walking_m_s=walking)
    return state, Command(linear_m_s=speed, angular_rad_s=turn)


def _turn(target: Target, speed: float, sight: Sight, config: FollowConfig) -> float:
    """Give the turn rate [rad/s] that faces the person, or past what stands beside the way there."""
    # A robot that stands need not avoid anything, and looks straight at the person.
    share = min(max(speed, 0.0) / config.swerve_from_m_s, 1.0)
    aside = share * swerve(target.bearing_rad, echoes(sight), config.avoid)
    return _facing_turn(target, config) + config.facing_gain * aside


def _facing_turn(target: Target, config: FollowConfig) -> float:
    """Give the turn rate [rad/s] that brings the person to the middle of the image and keeps it there."""
    return config.facing_gain * target.bearing_rad + config.drift_share * target.drift_rad_s


def _speed(target: Target, walking_m_s: float, config: FollowConfig) -> float:
    """Give the speed [m/s]: forwards when too far, none in between, slowly backwards when much too near."""
    if target.height >= config.near_height:
        beyond = target.height / config.near_height - 1.0
        return -min(config.back_off_gain * beyond, config.back_off_m_s)
    if target.height >= config.stop_height:
        return 0.0
    wanted = config.approach_gain * distance_error(target.height, config) + walking_m_s
    return _facing_share(target, config) * min(max(wanted, 0.0), config.max_linear_m_s)


def _facing_share(target: Target, config: FollowConfig) -> float:
    """Give the share of the speed that the bearing allows: 1 ahead, 0 where the robot should only turn."""
    left = config.turn_only_rad - abs(target.bearing_rad)
    return min(max(left / (config.turn_only_rad - config.full_speed_rad), 0.0), 1.0)


def _learn_walking(
    walking_m_s: float, target: Target, sight: Sight, step_s: float, config: FollowConfig
) -> float:
    """Integrate the distance error into the person's walking speed [m/s], 0 .. max_linear_m_s.

    It grows only while the robot drives about as fast as it wants to: held up by a wall, a turn or its own
    inertia, it would learn a speed that nobody walks at.
    """
    error = distance_error(target.height, config)
    wanted = config.approach_gain * error + walking_m_s
    is_held_up = wanted > sight.linear_m_s + 0.15 or wanted > config.max_linear_m_s
    if error > 0.0 and is_held_up:
        return walking_m_s
    return min(max(walking_m_s + config.learn_gain * error * step_s, 0.0), config.max_linear_m_s)


def _clip(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
