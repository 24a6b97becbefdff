"""Play a scenario without a tracker, to get the observations of its robot's sensors."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.percept import Percept
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.sim.observation import Observation, Senses
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD, WHEEL_DISTANCE_M

if TYPE_CHECKING:
    from peopleboy.sim.world import SimulatedWorld


def blind_drive(scenario: Scenario, seed: int) -> "Iterator[tuple[SimulatedWorld, Observation]]":
    """Yield the world and its observation at each instant; images are rendered only when accessed.

    Raises:
        BadInput: the robot's behaviour needs a tracker.
    """
    from peopleboy.sim.world import SimulatedWorld  # here, so that cached data can be read without PyBullet

    if scenario.needs_tracker:
        raise BadInput(f"{scenario.name}: its robot needs a tracker; give one that stands or is scripted")
    config, drive = scenario.world(seed), scenario.make_behaviour()
    with SimulatedWorld(config) as world:
        for _ in range(scenario.frames):
            observation = world.observe()
            yield world, observation
            command = drive.command(blind_percept(observation))
            world.step(command.linear_m_s, command.angular_rad_s)


def blind_percept(senses: Senses) -> Percept:
    """Return all that a scripted drive needs: the time, and for the guard, sonar ranges and speed."""
    left, right = senses.wheel_speeds_m_s
    return Percept(
        time_s=senses.time_s,
        people=(),
        sonar_m=senses.sonar_m,
        sonar_angle_rad=SONAR_ANGLE_RAD,
        linear_m_s=(left + right) / 2.0,
        angular_rad_s=(right - left) / WHEEL_DISTANCE_M,
    )
