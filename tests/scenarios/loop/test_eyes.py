from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.loop.loop import Eyes
from peopleboy.sim.world import World

EMPTY = {
    "name": "empty",
    "description": "Nobody is in a room that is colder than the thermal camera's span.",
    "duration_s": 1.0,
    "place": {"kind": "room", "length_m": 14.0, "width_m": 7.0},
    "robot": {"at_m": [1.0, 0.0]},
}


class Counter:
    """A tracker that counts the images it is given."""

    cameras = ("thermal",)

    def __init__(self):
        self.images = 0

    def update(self, frame):  # noqa: ARG002
        self.images += 1
        return ()


def test_images_of_a_cold_wall_are_new_ones_though_all_of_them_are_black(tmp_path):
    scenario = parse_scenario(EMPTY, source="test", folder=tmp_path)
    tracker = Counter()
    with World(scenario.world(0)) as world:
        eyes = Eyes(tracker, calibrations_of(world.cameras))
        for _ in range(3):
            observation = world.observe()
            assert not observation.images["thermal"].any()
            assert eyes.look(observation).image_age_s == 0.0
            world.step(0.0, 0.0)
    assert tracker.images == 3
