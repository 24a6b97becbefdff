import math
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.behaviours.behaviour import Command
from peopleboy.behaviours.percept import Percept
from peopleboy.behaviours.safety_guard import Guarded
from peopleboy.behaviours.scripted import Scripted
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD, WHEEL_DISTANCE_M, outline_gap
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.some_of import some_of

LENGTH, WIDTH = 8.0, 6.0
SCENE = {
    "name": "narrow",
    "description": "People stand about in a small room.",
    "duration_s": 60.0,
    "place": {"kind": "room", "length_m": LENGTH, "width_m": WIDTH},
    "people": [
        {"name": "anna", "path": [{"at_m": [4.5, 1.2]}]},
        {"name": "bert", "path": [{"at_m": [5.5, -1.4]}]},
    ],
    "robot": {"at_m": [2.0, 0.0]},
}  # fmt: skip
HULL = np.array([(x, y) for x in np.linspace(-0.30, 0.21, 9) for y in (-0.19, 0.0, 0.19)])


def any_commands(rng):
    """New speeds every now and then, at any limit."""
    times = np.cumsum(rng.uniform(0.5, 3.0, 60)) - 0.5
    speeds, turns = (
        rng.choice([0.8, 0.8, 0.5, -0.5, 0.0], 60),
        rng.choice([0.0, 0.0, 0.3, -0.3, 1.5, -1.5], 60),
    )
    return [
        (float(t), Command(linear_m_s=float(v), angular_rad_s=float(w)))
        for t, v, w in zip(times, speeds, turns, strict=True)
    ]


def wall_gap(pose):
    """Distance [m] from the hull to the nearest wall of the room."""
    cos, sin = math.cos(pose.heading), math.sin(pose.heading)
    x, y = (HULL @ np.array([[cos, sin], [-sin, cos]]) + (pose.x, pose.y)).T
    return min(x.min(), LENGTH - x.max(), WIDTH / 2.0 - y.max(), WIDTH / 2.0 + y.min())


def gaps_under_guard(tmp_path, seed):
    """Nearest gaps [m] to walls, and to people's middles; bodies touched; way driven [m]."""
    config = replace(
        parse_scenario(SCENE, source="test", folder=tmp_path).world(seed, "raycast"), renderer="none"
    )
    guarded = Guarded(Scripted(any_commands(np.random.default_rng(seed))))
    walls, people, touched, way = [], [], set(), 0.0
    with SimulatedWorld(config) as world:
        for _ in range(60 * 15):
            senses, scene = world.sense(), world.scene()
            left, right = senses.wheel_speeds_m_s
            command = guarded.command(
                Percept(
                    time_s=senses.time_s,
                    people=(),
                    sonar_m=senses.sonar_m,
                    sonar_angle_rad=SONAR_ANGLE_RAD,
                    linear_m_s=(left + right) / 2.0,
                    angular_rad_s=(right - left) / WHEEL_DISTANCE_M,
                )
            )
            walls.append(wall_gap(scene.robot))
            people.append(min(outline_gap(scene.robot, person.position_m) for person in scene.people))
            touched |= set(scene.contacts)
            way += abs(scene.robot_velocity[0]) / 15.0
            world.step(command.linear_m_s, command.angular_rad_s, is_emergency=command.is_emergency)
    return min(walls), min(people), touched, way


@pytest.mark.slow
@pytest.mark.parametrize("seed", some_of(range(2), 2))
def test_no_command_takes_the_robot_near_to_walls_or_people(seed, tmp_path):
    wall, person, touched, way = gaps_under_guard(tmp_path, seed)
    assert touched == set()
    assert way > 3.0
    assert person > 0.45
    assert wall > 0.2  # a turn on the spot swings the tail out
