"""Person following by position and height in the image: search, approach, and keep the distance."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from peopleboy.behaviours.behaviour import STOP, Command
from peopleboy.behaviours.dead_reckoning import RobotMotion
from peopleboy.behaviours.following.avoidance import (
    WIDELY,
    AvoidConfig,
    ClearanceConfig,
    is_person_near,
    is_way_out,
    swerve,
)
from peopleboy.behaviours.following.last_seen import (
    LastPlace,
    PlaceConfig,
    carry_place,
    end_of_way,
    on_the_way,
    place_of,
)
from peopleboy.behaviours.following.target import (
    OccluderConfig,
    Target,
    TargetConfig,
    carry_on,
    first_sight,
    forget_drift,
    hider,
    keep_behind,
    look_again,
)
from peopleboy.behaviours.percept import Percept, SeenPerson
from peopleboy.behaviours.sonar_echoes import EchoMemory, EchoMemoryConfig, echoes, remember


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowConfig:
    """Gains and limits of person following.

    Speeds depend on the distance error keep_height / height - 1: 0 at the wanted distance, 1 at twice that
    distance, independent of the person's size in metres.

    Attributes:
        keep_height: [image heights] apparent height to keep; 0.58 is 3.7 m for a person of 1.75 m. A level
            camera at 1.2 m shows whole people from 3 m on; the rest is a margin for those who turn back.
        stop_height: [image heights] from this height on the robot does not drive forwards.
        near_height: [image heights] from this height on the robot backs off.
        approach_gain: [m/s] forward speed per distance error.
        learn_gain: [m/s2] rate per distance error at which the person's walking speed is estimated.
        back_off_gain: [m/s] backward speed per share of height beyond near_height.
        back_off_m_s: [m/s] highest backward speed.
        max_linear_m_s: [m/s] highest forward speed.
        facing_gain: [1/s] turn rate per bearing.
        drift_share: share of the person's own angular speed that is added to the turn rate.
        max_turn_rad_s: [rad/s] highest turn rate; faster turns blur the thermal image.
        full_speed_rad: [rad] up to this bearing the robot drives at full speed ...
        turn_only_rad: [rad] ... and from this one on it only turns.
        swerve_from_m_s: [m/s] forward speed from which the robot swerves fully around obstacles.
        search_rad_s: [rad/s] turn rate while no person is visible.
        stalled_s: [s] without rotation after which a search changes its direction.
        wait_turn_rad_s: [rad/s] highest turn rate while waiting for a lost person.
        max_age_s: [s] greatest age of a track that is followed.
        wait_s: [s] from the last observation of a person who left the image until the search begins.
        patience_s: [s] waiting time for a person who is occluded by another one.
        gone_s: [s] the same for a person lost in the middle of the image without an occluder, behind a wall
            or by a missed detection; then the robot drives to the last position.
        recover_1_s: [1/s] speed per distance on the way there.
        give_up_s: [s] time without the person's track after which the robot may follow another person.
        min_confidence: people of lower confidence are not followed.
        leaving_rad: [rad] bearing, measured or predicted, from which a person has left the image.
        target: smoothing of measurements.
        hidden: conditions for people who can occlude the followed person.
        place: settings of the drive to the last position.
        avoid: obstacle avoidance.
        avoid_alone: the same on the way to the last position, without a person to keep in view.
        heard: memory of echoes for that, since an edge vanishes in the gaps between the sonars' cones.
        room: settings of making room for a person lost by being too near; otherwise the robot would block
            the door through which the person returns.
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
    patience_s: float = 5.0
    gone_s: float = 0.7
    recover_1_s: float = 0.6
    give_up_s: float = 30.0
    min_confidence: float = 0.5
    leaving_rad: float = math.radians(26.0)
    target: TargetConfig = field(default_factory=TargetConfig)
    hidden: OccluderConfig = field(default_factory=OccluderConfig)
    place: PlaceConfig = field(default_factory=PlaceConfig)
    avoid: AvoidConfig = field(default_factory=AvoidConfig)
    avoid_alone: AvoidConfig = WIDELY
    heard: EchoMemoryConfig = field(default_factory=lambda: EchoMemoryConfig(keep_s=4.0, within_m=1.7))
    room: ClearanceConfig = field(default_factory=ClearanceConfig)


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowState:
    """State of the follower between steps.

    Attributes:
        mode: "search", "follow", "wait" (just lost the person), "recover" (driving to the last position) or
            "blind" (no new, valid input).
        reason: reason for the mode.
        time_s: [s] time of the last valid percept.
        target: the followed person; None before the first one and after giving up.
        walking_m_s: [m/s] estimated speed at which the person walks away.
        side: +1 (left) or -1, direction of the search: the person's last direction of motion.
        has_left: whether the person was leaving the image sideways when last seen.
        place: last position of the person; None once the robot has been there.
        searched_rad: [rad] rotation of the search.
        stalled_s: [s] time without rotation: an obstacle blocks it.
        cleared_m: [m] distance driven in the search to make room.
        heard: echoes of the last seconds.
    """

    mode: str = "search"
    reason: str = "no person detected yet"
    time_s: float = -math.inf
    target: Target | None = None
    walking_m_s: float = 0.0
    side: int = 1
    has_left: bool = False
    place: LastPlace | None = None
    searched_rad: float = 0.0
    stalled_s: float = 0.0
    cleared_m: float = 0.0
    heard: EchoMemory = field(default_factory=EchoMemory)


class FollowPerson:
    """Person following as a behaviour: `follow` with stored state."""

    def __init__(self, config: FollowConfig | None = None) -> None:
        self._config = FollowConfig() if config is None else config
        self.state = FollowState()

    @property
    def mode(self) -> str:
        """Current activity."""
        return self.state.mode

    @property
    def reason(self) -> str:
        """Reason for the mode."""
        return self.state.reason

    @property
    def following(self) -> int | None:
        """Id of the followed track."""
        target = self.state.target
        return None if target is None or self.state.mode != "follow" else target.id

    def command(self, percept: Percept) -> Command:
        """Return the command for a percept."""
        self.state, command = follow(self.state, percept, self._config)
        return command


def follow(state: FollowState, percept: Percept, config: FollowConfig) -> tuple[FollowState, Command]:
    """Return the state and command of one step of person following.

    The robot follows a person only while the track is younger than max_age_s, and stops on invalid input or
    when time does not increase.

    Source: thesis, section 3.2: search by rotating, approach, keep the distance. The estimated walking speed,
    the drift, waiting and driving around corners are additions.
    """
    step_s = percept.time_s - state.time_s
    if not (percept.is_sound and step_s > 0.0):
        return replace(state, mode="blind", reason="invalid or old input"), STOP
    heard = remember(state.heard, percept, config.heard)
    state = replace(_update_target(state, percept, step_s, config), time_s=percept.time_s, heard=heard)
    if state.target is None:
        return _search(state, percept, step_s, config)
    gap_s = percept.time_s - state.target.seen_s
    if gap_s <= config.max_age_s:
        return _go_after(state, state.target, percept, step_s, config)
    if _is_too_near(state.target, gap_s, percept, config):
        return _make_room(state, state.target, config)
    why, patience_s = _patience(state, state.target, percept, config)
    if gap_s <= patience_s:
        return _wait(state, state.target, why, config)
    if state.place is not None and (not state.has_left or state.searched_rad > math.tau):
        return _recover(state, state.place, percept, step_s, config)
    return _search(state, percept, step_s, config)


def distance_error(height: float, config: FollowConfig) -> float:
    """Return the relative distance error; below 0 is too near."""
    return config.keep_height / height - 1.0


def _update_target(state: FollowState, percept: Percept, step_s: float, config: FollowConfig) -> FollowState:
    """Predict the followed person, find its track, and give it up after a long absence."""
    known = state.target
    gap_s = math.inf if known is None else percept.time_s - known.seen_s
    if known is None or gap_s > config.give_up_s:
        person = max(_can_be_followed(percept.people, config), key=lambda one: one.height, default=None)
        state = replace(state, target=None, place=None)
        return state if person is None else _sight(state, person, percept, config)
    person = next((one for one in _can_be_followed(percept.people, config) if one.id == known.id), None)
    if person is not None and gap_s > config.wait_s:
        return _sight(state, person, percept, config)
    motion = RobotMotion.of(percept, step_s)
    moved = carry_on(known, motion)
    if person is not None:
        return _seen_at(state, look_again(moved, person, percept.time_s, step_s, config.target), config)
    lost = forget_drift(moved, step_s, config.target)
    if config.max_age_s < gap_s < config.patience_s:
        lost = keep_behind(lost, percept.people, config.hidden, config.target)
    # After a pause, such as a stop without images, the last position is unknown.
    place = None if state.place is None or step_s > config.wait_s else carry_place(state.place, motion)
    return replace(state, target=lost, place=place)


def _can_be_followed(people: Iterable[SeenPerson], config: FollowConfig) -> list[SeenPerson]:
    """Return the people who are visible, with enough confidence."""
    return [
        one for one in people if one.is_sound and one.is_visible and one.confidence >= config.min_confidence
    ]


def _sight(state: FollowState, person: SeenPerson, percept: Percept, config: FollowConfig) -> FollowState:
    """Begin to follow a person, or go on after a pause, when the prediction is of no use."""
    return _seen_at(state, first_sight(person, percept.time_s, config.target), config)


def _seen_at(state: FollowState, seen: Target, config: FollowConfig) -> FollowState:
    """Store the state that is needed if this is the last observation of the person."""
    soon = seen.bearing_rad + seen.drift_rad_s * config.max_age_s
    later = seen.bearing_rad + seen.drift_rad_s * config.wait_s
    return replace(
        state,
        target=seen,
        side=1 if later >= 0.0 else -1,
        has_left=max(abs(seen.bearing_rad), abs(soon)) > config.leaving_rad,
        place=place_of(seen, config.place),
        searched_rad=0.0,
        cleared_m=0.0,
    )


def _patience(
    state: FollowState, target: Target, percept: Percept, config: FollowConfig
) -> tuple[str, float]:
    """Return how the person was lost, and the waiting time [s]."""
    if state.has_left:
        return f"track {target.id} left the image", config.wait_s
    front = hider(percept.people, target, config.hidden, config.target)
    if front is not None:
        return f"track {target.id} is occluded by track {front.id}", config.patience_s
    return f"track {target.id} is not visible", config.gone_s


def _search(
    state: FollowState, percept: Percept, step_s: float, config: FollowConfig
) -> tuple[FollowState, Command]:
    """Rotate in place towards the side where the person was last seen; if blocked, to the other."""
    is_stalled = state.mode == "search" and abs(percept.angular_rad_s) < 0.1 * config.search_rad_s
    stalled_s = state.stalled_s + min(step_s, config.max_age_s) if is_stalled else 0.0
    if stalled_s > config.stalled_s:
        state, stalled_s = replace(state, side=-state.side), 0.0
    turn = state.side * config.search_rad_s
    turned = state.searched_rad + abs(percept.angular_rad_s) * min(step_s, config.max_age_s)
    if state.mode in ("follow", "wait", "blind"):
        state = replace(state, reason="the person has not returned")
    state = replace(state, mode="search", walking_m_s=0.0, stalled_s=stalled_s, searched_rad=turned)
    if turned > math.tau:
        gone_m = state.cleared_m + max(percept.linear_m_s, 0.0) * min(step_s, config.max_age_s)
        state = replace(state, cleared_m=gone_m)
        if is_way_out(echoes(percept), config.room, gone_m):
            return state, Command(linear_m_s=config.room.speed_m_s, angular_rad_s=0.0)
    return state, Command(linear_m_s=0.0, angular_rad_s=turn)


def _wait(state: FollowState, target: Target, why: str, config: FollowConfig) -> tuple[FollowState, Command]:
    """Stand, and turn slowly towards the predicted bearing."""
    turn = _clip(_facing_turn(target, config), config.wait_turn_rad_s)
    return replace(state, mode="wait", reason=why), Command(linear_m_s=0.0, angular_rad_s=turn)


def _is_too_near(target: Target, gap_s: float, percept: Percept, config: FollowConfig) -> bool:
    """Return whether the person was lost by being too near: an obstacle is close ahead now."""
    was_near = target.height >= config.near_height
    return gap_s <= config.room.longest_s and is_person_near(echoes(percept), config.room, was_near=was_near)


def _make_room(state: FollowState, target: Target, config: FollowConfig) -> tuple[FollowState, Command]:
    """Back off, facing the person."""
    turn = _clip(_facing_turn(target, config), config.wait_turn_rad_s)
    state = replace(state, mode="wait", reason=f"track {target.id} is too near for the camera")
    return state, Command(linear_m_s=-config.room.speed_m_s, angular_rad_s=turn)


def _recover(
    state: FollowState, place: LastPlace, percept: Percept, step_s: float, config: FollowConfig
) -> tuple[FollowState, Command]:
    """Drive to the person's last position, and search there in the person's direction of motion."""
    place = on_the_way(place, percept, step_s)
    end = end_of_way(place, echoes(percept), config.place)
    if end:
        state = replace(state, mode="recover", reason=end, place=None, searched_rad=0.0)
        return _search(state, percept, step_s, config)
    aim = place.bearing_rad + swerve(place.bearing_rad, state.heard.points, config.avoid_alone)
    speed = min(config.recover_1_s * place.distance_m, config.max_linear_m_s)
    speed, turn = _facing_share(aim, config) * speed, config.facing_gain * aim
    state = replace(state, mode="recover", reason="driving to the person's last position", place=place)
    return state, Command(linear_m_s=speed, angular_rad_s=_clip(turn, config.max_turn_rad_s))


def _go_after(
    state: FollowState, target: Target, percept: Percept, step_s: float, config: FollowConfig
) -> tuple[FollowState, Command]:
    """Turn towards the person and close the distance."""
    walking = _learn_walking(state.walking_m_s, target, percept, step_s, config)
    speed = _speed(target, walking, config)
    turn = _clip(_turn(target, speed, percept, config), config.max_turn_rad_s)
    why = f"track {target.id} is visible"
    state = replace(state, mode="follow", reason=why, walking_m_s=walking)
    return state, Command(linear_m_s=speed, angular_rad_s=turn)


def _turn(target: Target, speed: float, percept: Percept, config: FollowConfig) -> float:
    """Return the turn rate [rad/s] that faces the person, or avoids obstacles next to the path."""
    # A standing robot does not avoid obstacles, and faces the person.
    share = min(max(speed, 0.0) / config.swerve_from_m_s, 1.0)
    aside = share * swerve(target.bearing_rad, echoes(percept), config.avoid)
    return _facing_turn(target, config) + config.facing_gain * aside


def _facing_turn(target: Target, config: FollowConfig) -> float:
    """Return the turn rate [rad/s] that centres the person in the image."""
    return config.facing_gain * target.bearing_rad + config.drift_share * target.drift_rad_s


def _speed(target: Target, walking_m_s: float, config: FollowConfig) -> float:
    """Return the speed [m/s]: forwards when too far, zero in between, slowly backwards when much too near."""
    if target.height >= config.near_height:
        beyond = target.height / config.near_height - 1.0
        return -min(config.back_off_gain * beyond, config.back_off_m_s)
    if target.height >= config.stop_height:
        return 0.0
    wanted = config.approach_gain * distance_error(target.height, config) + walking_m_s
    return _facing_share(target.bearing_rad, config) * min(max(wanted, 0.0), config.max_linear_m_s)


def _facing_share(bearing_rad: float, config: FollowConfig) -> float:
    """Return the factor on the speed by bearing: 1 ahead, 0 where the robot should only turn."""
    left = config.turn_only_rad - abs(bearing_rad)
    return min(max(left / (config.turn_only_rad - config.full_speed_rad), 0.0), 1.0)


def _learn_walking(
    walking_m_s: float, target: Target, percept: Percept, step_s: float, config: FollowConfig
) -> float:
    """Integrate the distance error into the person's walking speed [m/s], 0 .. max_linear_m_s.

    The estimate is updated only while the robot drives about as fast as commanded. Otherwise, when held up by
    a wall, a turn or inertia, it would be too high.
    """
    error = distance_error(target.height, config)
    wanted = config.approach_gain * error + walking_m_s
    is_held_up = wanted > percept.linear_m_s + 0.15 or wanted > config.max_linear_m_s
    if error > 0.0 and is_held_up:
        return walking_m_s
    return min(max(walking_m_s + config.learn_gain * error * step_s, 0.0), config.max_linear_m_s)


def _clip(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
