"""Draw the robot of a random world: its start, its drive and its cameras."""

from __future__ import annotations

import math
from typing import Final

from peopleboy.scenarios.random_worlds.attempts import Data, rounded
from peopleboy.scenarios.random_worlds.distribution import Draws
from peopleboy.scenarios.random_worlds.draw_place import draw_point
from peopleboy.sim.cameras.camera_config import COLOUR_BASELINE_M, COLOUR_ZOOM
from peopleboy.sim.geometry.pinhole import Pinhole

_AIMS: Final = 4


def draw_robot(draws: Draws, place: Data, duration_s: float) -> Data:
    """Draw a robot, which looks about as far as the place reaches: at the farthest of four points."""
    at = draw_point(draws, place)
    aims = [draw_point(draws, place) for _ in range(_AIMS)]
    robot: Data = {
        "at_m": at,
        "heading_deg": rounded(
            _towards(at, max(aims, key=lambda aim: math.dist(at, aim))) + draws.number("heading_off")
        ),
        "cameras": draw_cameras(draws),
    }
    if draws.one_of("robot") == "drives":
        robot |= {"behaviour": "scripted", "commands": _drive(draws, duration_s)}
    return robot


def draw_cameras(draws: Draws) -> Data:
    """Draw a thermal camera, with the colour camera beside it, which sees a little less."""
    ahead, _, _ = Pinhole().position_m
    height, pitch, angle = (draws.number(name) for name in ("camera_height", "pitch", "vertical_fov"))
    narrower = 2.0 * math.degrees(math.atan(math.tan(math.radians(angle / 2.0)) / COLOUR_ZOOM))
    thermal = {
        "kind": "thermal",
        "mount_m": [ahead, 0.0, height],
        "pitch_deg": pitch,
        "vertical_fov_deg": angle,
        "blur_px": draws.number("blur"),
        "netd_k": draws.number("netd"),
        "fixed_pattern_k": draws.number("fixed_pattern"),
        "dead_pixels": draws.number("dead_pixels"),
    }
    colour = {
        "kind": "colour",
        "mount_m": [ahead, COLOUR_BASELINE_M, height],
        "pitch_deg": pitch,
        "vertical_fov_deg": rounded(narrower),
    }
    return {"thermal": thermal, "colour": colour}


def _towards(at: list[float], aim: list[float]) -> float:
    """Heading [deg] from a point to another."""
    return math.degrees(math.atan2(aim[1] - at[1], aim[0] - at[0]))


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
