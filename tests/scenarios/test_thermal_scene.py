"""People are shown the room of every scenario, whatever the tracker gets; automatic gains show it to both."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from peopleboy.scenarios.files.library import LIBRARY
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.cameras.camera_config import ThermalConfig
from peopleboy.sim.cameras.kinds import THERMAL_PRESETS
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.some_of import some_of

NAMES = sorted(path.stem for path in LIBRARY.glob("*.yaml"))


@pytest.mark.slow
@pytest.mark.parametrize("name", some_of(NAMES, 8))
def test_less_than_one_percent_of_what_people_are_shown_is_clipped(name: str) -> None:
    with SimulatedWorld(load_scenario(name).world(0)) as world:
        for _ in range(3):
            scene = world.observe().images["thermal_scene"]
            assert scene.dtype == np.uint8
            assert np.isin(scene, (0, 255)).mean() < 0.01
            # There is more than one or two greys to see.
            assert np.percentile(scene, 95) - np.percentile(scene, 5) > 8
            for _ in range(8):
                world.step(0.0, 1.2)


@pytest.mark.slow
@pytest.mark.parametrize("name", some_of(NAMES[::12], 3))
@pytest.mark.parametrize(
    "thermal",
    [ThermalConfig(gain="percentile"), ThermalConfig(gain="plateau"), THERMAL_PRESETS["uncooled_film"]],
    ids=["percentile", "plateau", "film"],
)
def test_nor_of_what_the_robot_gets_by_an_automatic_gain_while_it_turns(
    name: str, thermal: ThermalConfig
) -> None:
    config = load_scenario(name).world(0)
    cameras = {**config.robot.cameras, "thermal": thermal}
    with SimulatedWorld(replace(config, robot=replace(config.robot, cameras=cameras))) as world:
        for k in range(16):
            grey = world.observe().images["thermal"]
            assert np.isin(grey, (0, 255)).mean() < 0.01
            world.step(0.0, 1.5 if k > 4 else 0.0)
