"""Play a scenario without a tracker, for what its robot's sensors observe."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.percept import Percept
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.sim.observation import Observation
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD, WHEEL_DISTANCE_M

if TYPE_CHECKING:
    from peopleboy.sim.world import World


def blind_drive(scenario: Scenario, seed: int) -> "Iterator[tuple[World, Observation]]":
    """Yield the world and what was observed, instant by instant; images that nobody asks for are never made.

    Raises:
        BadInput: the robot needs eyes to drive.
    """
    from peopleboy.sim.world import World  # here, as what was made before can be read without PyBullet

    if scenario.robot.behaviour not in ("stand", "scripted"):
        raise BadInput(f"{scenario.name}: take a scenario whose robot stands or is scripted")
    config, drive = scenario.world(seed), scenario.make_behaviour()
    with World(config) as world:
        for _ in range(round(scenario.duration_s * config.control_hz)):
            observation = world.observe()
            yield world, observation
            command = drive.command(_blind_percept(observation))
            world.step(command.linear_m_s, command.angular_rad_s)


def _blind_percept(observation: Observation) -> Percept:
    """Tell a drive by the clock all that it asks for: the time, and what its guard does, sonars and speed."""
    left, right = observation.wheel_speeds_m_s
    return Percept(
        time_s=observation.time_s,
        people=(),
        sonar_m=observation.sonar_m,
        sonar_angle_rad=SONAR_ANGLE_RAD,
        linear_m_s=(left + right) / 2.0,
        angular_rad_s=(right - left) / WHEEL_DISTANCE_M,
    )
