"""People are shown the room of every scenario, whatever the tracker gets."""

from __future__ import annotations

import numpy as np
import pytest

from peopleboy.scenarios.files.load import LIBRARY, load_scenario
from peopleboy.sim.world import World

NAMES = sorted(path.stem for path in LIBRARY.glob("*.yaml"))


@pytest.mark.parametrize("name", NAMES)
def test_less_than_one_percent_of_what_people_are_shown_is_clipped(name: str) -> None:
    with World(load_scenario(name).world(0)) as world:
        for _ in range(3):
            scene = world.observe().images["thermal_scene"]
            assert scene.dtype == np.uint8
            assert np.isin(scene, (0, 255)).mean() < 0.01
            # There is more than one or two greys to see.
            assert np.percentile(scene, 95) - np.percentile(scene, 5) > 8
            for _ in range(8):
                world.step(0.0, 1.2)
