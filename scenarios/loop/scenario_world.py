"""The simulated world of a scenario, made from the scenario's name."""

from collections.abc import Sequence
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig


class World(SimulatedWorld):
    """A simulated world; use it as a context manager.

    `observe` returns the robot's sensor readings, and `truth` the ground truth of the same instant. `step`
    drives the robot for one control step, 1/15 s.

        with World("crossing_2", seed=3) as world:
            tracker = make_tracker("detection")
            for _ in range(45):
                tracks = tracker.update(Frame.from_observation(world.observe()))
                world.step(0.2, 0.0)

    Args:
        scenario: a library name, the path of a YAML file, a loaded scenario, or the settings of a world.
        seed: seed of all random numbers; None for that of the scenario, which is 0 unless a run wrote it.
        cameras: additional cameras for the robot, such as `tracker.cameras`; mounted with default settings.
        renderer: "raycast", or "bullet", a slow reference.

    Raises:
        BadInput: the scenario does not exist, or an argument is invalid.
    """

    def __init__(
        self,
        scenario: str | Path | Scenario | WorldConfig,
        seed: int | None = None,
        *,
        cameras: Sequence[str] = (),
        renderer: str = "raycast",
    ) -> None:
        if isinstance(scenario, WorldConfig):
            if seed is not None or cameras:
                raise BadInput("the settings of a world include seed and cameras; leave both out")
            super().__init__(scenario)
            return
        loaded = load_scenario(scenario).mounting(cameras)
        super().__init__(loaded.world(loaded.seed if seed is None else seed, renderer))
