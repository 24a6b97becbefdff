"""Draw the robot of a random world: its start, its drive and its cameras."""

from __future__ import annotations

import math
from typing import Final

from peopleboy.scenarios.random_worlds.attempts import Data, rounded
from peopleboy.scenarios.random_worlds.distribution import Draws
from peopleboy.scenarios.random_worlds.draw_place import draw_point, plan_of
from peopleboy.sim.cameras.camera_config import COLOUR_BASELINE_M, COLOUR_ZOOM
from peopleboy.sim.geometry.pinhole import Pinhole

_AIMS: Final = 4
_TRIES: Final = 8
_AHEAD_M: Final = 3.0  # of floor before the robot, if it can be
_WALL_M: Final = 0.1
_FREE_M, _FREE_RAD = 1.5, math.radians(40.0)


def draw_robot(draws: Draws, place: Data, duration_s: float) -> Data:
    """Draw a robot, which looks about as far as the place reaches."""
    at, heading = _stance(draws, place)
    robot: Data = {"at_m": at, "heading_deg": heading, "cameras": draw_cameras(draws)}
    if draws.one_of("robot") == "drives":
        robot |= {"behaviour": "scripted", "commands": _drive(draws, duration_s)}
    return robot


def draw_cameras(draws: Draws) -> Data:
    """Draw a thermal camera, with the colour camera beside it, which sees a little less."""
    ahead, _, _ = Pinhole().position_m
    height, pitch, angle = (draws.number(name) for name in ("camera_height", "pitch", "vertical_fov"))
    narrower = 2.0 * math.degrees(math.atan(math.tan(math.radians(angle / 2.0)) / COLOUR_ZOOM))
    thermal: Data = {
        "kind": "thermal",
        "mount_m": [ahead, 0.0, height],
        "pitch_deg": pitch,
        "vertical_fov_deg": angle,
        "blur_px": draws.number("blur"),
        "netd_k": draws.number("netd"),
        "fixed_pattern_k": draws.number("fixed_pattern"),
        "dead_pixels": draws.number("dead_pixels"),
        "column_noise_k": draws.number("column_noise"),
        "vignetting_k": draws.number("vignetting"),
        "offset_drift_k_per_min": draws.number("drift"),
        "sharpening": draws.number("sharpening"),
        "coring_k": draws.number("coring"),
        **_draw_gain(draws),
    }
    if draws.happens("has_shutter"):
        thermal["shutter_every_s"] = draws.number("shutter_every")
    if draws.happens("is_film"):
        thermal["jpeg_quality"] = draws.count("jpeg_quality")
    colour = {
        "kind": "colour",
        "mount_m": [ahead, COLOUR_BASELINE_M, height],
        "pitch_deg": pitch,
        "vertical_fov_deg": rounded(narrower),
    }
    return {"thermal": thermal, "colour": colour}


def _draw_gain(draws: Draws) -> Data:
    """Draw an automatic gain, so that the room is seen whatever its temperature is."""
    gain: Data = {
        "gain": draws.one_of("gain"),
        "gain_follows_s": draws.number("gain_follows"),
        "tail_percent": draws.number("tail"),
        "least_span_k": draws.number("least_span"),
    }
    if gain["gain"] == "plateau":
        gain |= {"plateau_percent": draws.number("plateau"), "linear_share": draws.number("linear_share")}
    return gain


def is_before(robot: Data, at: list[float]) -> bool:
    """Tell whether a point is so near before the robot that a thing there would fill its view."""
    ahead, aside = at[0] - robot["at_m"][0], at[1] - robot["at_m"][1]
    off = math.remainder(math.atan2(aside, ahead) - math.radians(robot["heading_deg"]), math.tau)
    return math.hypot(ahead, aside) < _FREE_M and abs(off) < _FREE_RAD


def _stance(draws: Draws, place: Data) -> tuple[list[float], float]:
    """Draw a point and a heading [deg] past the farthest of four others, most likely with floor ahead."""
    areas = [area.grown(-_WALL_M) for _, area in plan_of(place).areas]
    for _ in range(_TRIES):
        at = draw_point(draws, place)
        x, y = max((draw_point(draws, place) for _ in range(_AIMS)), key=lambda aim: math.dist(at, aim))
        heading = math.degrees(math.atan2(y - at[1], x - at[0])) + draws.number("heading_off")
        cos, sin = math.cos(math.radians(heading)), math.sin(math.radians(heading))
        if any(area.contains(at[0] + _AHEAD_M * cos, at[1] + _AHEAD_M * sin) for area in areas):
            break
    return at, rounded(heading)


def _drive(draws: Draws, duration_s: float) -> list[Data]:
    """Draw commands: straight on, curves, turning on the spot, and stops."""
    commands: list[Data] = []
    at = 0.0
    while at < duration_s:
        way = draws.one_of("command")
        linear = draws.number("drive_speed") if way in ("straight", "curve") else 0.0
        turn = draws.number("drive_turn") if way in ("turn", "curve") else 0.0
        commands.append({"from_s": rounded(at), "linear_m_s": linear, "angular_deg_s": turn})
        at += draws.number("drive_lasts")
    return commands
