"""Limits of commands: the drive's limits, and obstacles measured by the sonars."""

import math
from dataclasses import dataclass

import numpy as np

from peopleboy.behaviours.behaviour import STOP, Command
from peopleboy.behaviours.percept import Percept, Points
from peopleboy.behaviours.sonar_echoes import BESIDE_RAD, echoes
from peopleboy.geometry.collision_course import times_to_collision

NOTHING_REMEMBERED: Points = np.zeros((0, 2))
NOTHING_REMEMBERED.setflags(write=False)
_NEAR_M = 1.6  # [m] obstacles farther from the robot's origin cannot enter the margin before the robot stops
_SHARES = np.arange(8, -1, -1) / 8.0  # of a wanted speed, the fastest first
_ARC_M = np.arange(1, 19) * 0.05  # checked arc lengths; the braking distance from 0.8 m/s is 0.84 m


@dataclass(frozen=True, slots=True, kw_only=True)
class SafetyConfig:
    """Limits and outline of the robot, and its clearance from obstacles.

    Frame: x forward, y left, origin between the wheels.

    Attributes:
        max_linear_m_s: [m/s] forward speed limit, also backwards.
        max_angular_rad_s: [rad/s] turn rate limit.
        unproven_m_s: [m/s] forward speed limit until the first echo: slow enough for a harmless collision
            with a wall.
        last_m: [m] a robot without echoes stops when it has no more than this left to drive.
        braking_m_s2: [m/s2] assumed deceleration; lower than the drive's 0.6, as a reserve.
        reaction_s: [s] from an echo until the brakes act: a frame of latency, and a drive that still
            accelerates.
        margin_m: [m] clearance between the hull and obstacles while driving; a turn on the spot may swing the
            tail nearer, as a robot next to a wall must be able to turn away from it.
        noise_m, shallow, closest_m: [m], [m/m], [m] within the margin, the clearance may shrink by noise_m,
            and by shallow per distance driven, but not below closest_m, because sonars cannot distinguish a
            parallel wall from one that slowly approaches.
        off_middle_m: [m] greatest distance from the middle of a passage too narrow for the margin.
        hull_m: [m] half the hull's width.
        front_m, rear_m: [m] from the origin to the hull's front and rear edge.
        half_width_m: [m] half of the lane that must be free: half the hull plus a hand's breadth.
        corner_m: [m] from the origin to the farthest corner of the hull, which swings out in a turn.
        free_turn_m: [m] obstacles farther from the origin than this do not limit turning.
        tight_turn_rad_s: [rad/s] turn rate with an obstacle at the corner's distance.
        latest_image_s: [s] time without a new image after which the robot stops: at 15 Hz the first missing
            image.
        resume_images: number of new images in a row after which a robot that stopped drives
            again, so that it does not start and stop while a camera loses every few images.
        walking_m_s: [m/s] slower people stand: the sonars detect them.
        comfort_m: [m] distance from the robot's origin to the middle of a walking person, who should not come
            nearer.
        foresight_s: [s] time for which people and the robot are expected to keep their velocities.
        slack_m: [m] a person who is nearer already may come nearer by this.
    """

    max_linear_m_s: float = 0.8
    max_angular_rad_s: float = math.radians(150.0)
    unproven_m_s: float = 0.05
    last_m: float = 0.1
    braking_m_s2: float = 0.5
    reaction_s: float = 0.25
    margin_m: float = 0.45
    noise_m: float = 0.01
    shallow: float = 0.1
    closest_m: float = 0.4
    off_middle_m: float = 0.1
    hull_m: float = 0.19
    front_m: float = 0.23
    rear_m: float = 0.32
    half_width_m: float = 0.27
    corner_m: float = 0.36
    free_turn_m: float = 0.55
    tight_turn_rad_s: float = 0.3
    latest_image_s: float = 0.05
    resume_images: int = 3
    walking_m_s: float = 0.3
    comfort_m: float = 1.5
    foresight_s: float = 3.0
    slack_m: float = 0.2


def limit(
    command: Command,
    percept: Percept,
    config: SafetyConfig,
    remembered: Points = NOTHING_REMEMBERED,
    passing: Points = NOTHING_REMEMBERED,
) -> Command:
    """Change a command as little as needed so that the robot can always stop before obstacles.

    The result is within the drive's limits; its components keep their sign or are zero. Invalid input stops
    the robot; a sonar range of NaN counts as an obstacle at the sonar itself.

    Args:
        command: command of a behaviour.
        percept: percept with the sonars' ranges.
        config: limits and outline.
        remembered: (N, 2) [m] further obstacles, robot frame, which limit turning: a corner of the hull
            swings through the gaps between the sonars' cones.
        passing: (M, 2) [m] recent obstacles next to the robot's path, robot frame.
    """
    if not percept.is_sound:
        return STOP
    points = echoes(percept)
    beside = np.concatenate([echoes(percept, spread_rad=BESIDE_RAD), passing])
    arc = _free_arc(command, beside[np.hypot(beside[:, 0], beside[:, 1]) < _NEAR_M], config)
    ahead, behind = _free_way(points, config)
    backwards, forwards = -safe_speed(min(behind, arc), config), safe_speed(min(ahead, arc), config)
    turn = _safe_turn(command.angular_rad_s, np.concatenate([points, remembered]), config)
    return Command(
        linear_m_s=give_way(min(max(command.linear_m_s, backwards), forwards), percept, config),
        angular_rad_s=min(max(command.angular_rad_s, -turn), turn),
    )


def give_way(linear_m_s: float, percept: Percept, config: SafetyConfig) -> float:
    """Return the speed [m/s], from the wanted one to 0, at which walking people stay away longest.

    All keep their velocities. Of speeds at which no person comes near within the foresight, the result is the
    one next to the wanted speed; so a robot does not slow down behind a person who walks away.
    """
    walking = [
        (*person.position_m, *person.velocity_m_s)
        for person in percept.people
        if person.position_m is not None
        and person.velocity_m_s is not None
        and math.hypot(*person.velocity_m_s) > config.walking_m_s
    ]
    speeds = linear_m_s * _SHARES
    gaps, velocities = np.split(np.repeat(np.reshape(walking, (1, -1, 4)), len(speeds), axis=0), 2, axis=2)
    velocities = velocities - np.stack([speeds, np.zeros(len(speeds))], axis=1)[:, None]
    near_m = np.minimum(
        config.comfort_m, np.maximum(np.hypot(gaps[..., 0], gaps[..., 1]) - config.slack_m, 0.0)
    )
    times = times_to_collision(gaps.reshape(-1, 2), velocities.reshape(-1, 2), near_m.ravel())
    soonest = np.min(times.reshape(len(speeds), -1), axis=1, initial=config.foresight_s)
    return float(speeds[np.argmax(soonest)])


def safe_speed(room_m: float, config: SafetyConfig) -> float:
    """Return the highest speed [m/s] from which the robot stops within a distance room_m [m].

    The larger root of reaction * v + v^2 / (2 a) = room, at most the drive's limit.
    """
    if room_m <= 0.0:
        return 0.0
    lost = config.braking_m_s2 * config.reaction_s
    return min(math.sqrt(lost**2 + 2.0 * config.braking_m_s2 * room_m) - lost, config.max_linear_m_s)


def _free_way(points: Points, config: SafetyConfig) -> tuple[float, float]:
    """Return the free distance [m] ahead and behind, in the lane of the hull, minus the margin."""
    x = points[np.abs(points[:, 1]) < config.half_width_m, 0]
    ahead = np.min(x[x > 0.0], initial=np.inf) - config.front_m
    behind = np.min(-x[x <= 0.0], initial=np.inf) - config.rear_m
    return float(ahead) - config.margin_m, float(behind) - config.margin_m


def _free_arc(command: Command, points: Points, config: SafetyConfig) -> float:
    """Return the distance [m] along the commanded arc until the hull is too near an obstacle, or inf.

    Too near is nearer than the margin, and nearer than at the current position.
    """
    if command.linear_m_s == 0.0:
        return math.inf
    bend = command.angular_rad_s / abs(command.linear_m_s)  # [rad/m]
    ways = _ARC_M[np.abs(bend) * _ARC_M < math.pi / 2.0]
    now = float(np.min(_gaps(points, config), initial=math.inf))
    allowed = np.maximum(now - config.noise_m - config.shallow * ways, min(now, config.closest_m))  # (K,)
    margin_m = _side_margin(points, config) if command.linear_m_s > 0.0 else config.margin_m
    too_near = np.minimum(margin_m, allowed)
    turned = bend * ways
    chord = math.copysign(1.0, command.linear_m_s) * ways * np.sinc(turned / math.tau)
    moved = points[None] - (chord * np.stack([np.cos(turned / 2.0), np.sin(turned / 2.0)])).T[:, None]
    cos, sin = np.cos(turned)[:, None], np.sin(turned)[:, None]
    x, y = moved[..., 0], moved[..., 1]
    then = _gaps(np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1), config)  # (K, N)
    is_too_near = (then < too_near[:, None]).any(axis=1)
    return float(ways[np.argmax(is_too_near)]) - 0.05 if is_too_near.any() else math.inf


def _side_margin(points: Points, config: SafetyConfig) -> float:
    """Return the margin [m]; in a narrow passage ahead, such as a door, half of the remaining width."""
    x, y = points[points[:, 0] > -config.rear_m].T
    if np.any((x > 0.0) & (np.abs(y) < config.half_width_m)):
        return config.margin_m  # there is no passage
    left = np.min(y[y > 0.0], initial=math.inf)
    right = np.min(-y[y < 0.0], initial=math.inf)
    middle = float(left + right) / 2.0 - config.hull_m
    return min(config.margin_m, max(middle - config.off_middle_m, 0.0))


def _gaps(points: Points, config: SafetyConfig) -> Points:
    """Return the distance [m] of points (..., 2) from the hull."""
    x, y = points[..., 0], points[..., 1]
    along = np.maximum(np.maximum(x - config.front_m, -config.rear_m - x), 0.0)
    gaps: Points = np.hypot(along, np.maximum(np.abs(y) - config.hull_m, 0.0))
    return gaps


def _safe_turn(wanted_rad_s: float, points: Points, config: SafetyConfig) -> float:
    """Return the highest turn rate [rad/s] in the wanted direction, given obstacles next to the hull."""
    distance = np.hypot(points[:, 0], points[:, 1])
    room_m = float(np.min(distance)) - config.corner_m
    if room_m > 0.0:
        share = min(room_m / (config.free_turn_m - config.corner_m), 1.0)
        return config.tight_turn_rad_s + share * (config.max_angular_rad_s - config.tight_turn_rad_s)
    x, y = points[distance <= config.corner_m].T
    # Turning left, the corners swing towards obstacles ahead-left and behind-right; obstacles abreast do not
    # matter, and a robot next to a wall must be able to turn away from it.
    is_swept = (wanted_rad_s * x * y > 0.0) & (np.abs(x) > 0.5 * np.abs(y))
    return 0.0 if is_swept.any() else config.tight_turn_rad_s
