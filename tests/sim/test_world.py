import hashlib
import math
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import peopleboy.sim.world as world_module
from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.physics import bullet
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.shapes.materials import Material, Painting
from peopleboy.sim.world import SimulatedWorld, light_level
from peopleboy.sim.world_config import WorldConfig
from tests.helpers.calls.refused import refused
from tests.helpers.worlds.small_worlds import NO_NOISE, SMALL, box_thing, config, hall, person, robot

QUIET = replace(NO_NOISE, camera=SMALL)
WALKERS = (
    person("ann", (4.0, -1.0), (7.0, 1.0), (3.0, 1.0), sex="female"),
    person("ben", (5.0, 1.2), (5.0, -1.2), (6.0, 0.0), yields=True, bag=True),
)


def open_worlds() -> int:
    return sum(bullet.pybullet.getConnectionInfo(client)["isConnected"] for client in range(64))


@pytest.fixture(autouse=True)
def no_world_is_left_open() -> Iterator[None]:
    before = open_worlds()
    yield
    assert open_worlds() == before


def test_a_world_of_one_temperature_gives_one_value(monkeypatch: pytest.MonkeyPatch) -> None:
    make = world_module.make_material_table

    def at_one_temperature(
        materials: list[Material], rng: np.random.Generator, paintings: list[Painting | None]
    ) -> object:
        same = [replace(k, temperature_c=29.0, variation_k=0.0, contrast_k=0.0) for k in materials]
        return make(same, rng, paintings)

    monkeypatch.setattr(world_module, "make_material_table", at_one_temperature)
    place = replace(hall(), surroundings_c=29.0)
    with SimulatedWorld(config(*WALKERS, place=place, robot=robot(thermal=QUIET))) as world:
        for _ in range(5):
            image = world.observe().images["thermal_c"]
            assert image == pytest.approx(29.0, abs=2e-3)
            world.step(0.3, 2.0)


@pytest.mark.parametrize("temperature", [25.0, 33.3])
def test_a_black_body_reads_its_temperature(temperature: float) -> None:
    material = Material(temperature_c=temperature, emissivity=1.0)
    target = box_thing("target", (0.2, 3.0, 2.6), (3.0, 0.0, 1.3), material)
    with SimulatedWorld(config(place=hall(target), robot=robot(thermal=QUIET))) as world:
        assert world.observe().images["thermal_c"] == pytest.approx(temperature, abs=0.05)


def test_the_8_bit_image_is_the_source_s_line() -> None:
    with SimulatedWorld(config(*WALKERS)) as world:
        images = dict(world.observe().images)
    exact = np.clip(np.round((images["thermal_c"].astype(float) - 24.0) / 12.0 * 255.0), 0, 255)
    assert np.abs(images["thermal"] - exact).max() <= 1
    assert (images["thermal"] == exact).mean() > 0.999
    assert images["thermal"].dtype == np.uint8
    assert images["thermal"].shape == (120, 160)
    assert images["colour"].shape == (120, 160, 3)


def test_people_are_warmer_than_what_is_behind_them() -> None:
    with SimulatedWorld(config(*WALKERS)) as world:
        image, mask = world.observe().images["thermal_c"], world.truth().instance > 0
    assert mask.sum() > 300
    assert image[mask].mean() > image[~mask].mean() + 5.0


def test_the_light_goes_out_at_its_time() -> None:
    place = replace(hall(), light=((0.0, 1.0), (0.2, 0.3), (0.4, 0.0)))
    assert [light_level(place, time_s) for time_s in (0.0, 0.1, 0.2, 0.39, 0.4, 9.0)] == [
        1,
        1,
        0.3,
        0.3,
        0,
        0,
    ]
    with SimulatedWorld(config(*WALKERS, place=place)) as world:
        colours, thermals = [], []
        for _ in range(8):
            observation = world.observe()
            colours.append(observation.images["colour"].mean())
            thermals.append(observation.images["thermal_c"].mean())
            world.step(0.0, 0.0)
    assert min(colours[:3]) > max(colours[3:6]) > 5.0
    assert min(colours[3:6]) > 4.0 * max(colours[6:])
    assert np.ptp(thermals) < 0.2


def test_turning_blurs_the_image_and_driving_straight_does_not() -> None:
    edge = box_thing("edge", (0.1, 2.0, 2.6), (4.0, 1.0, 1.3), Material(temperature_c=32.0))

    def width_of_edge(command: tuple[float, float], steps: int, heading_deg: float) -> int:
        settings = {"place": hall(edge), "robot": robot(heading_deg=heading_deg, thermal=QUIET)}
        with SimulatedWorld(config(**settings)) as world:
            for _ in range(steps):
                world.step(*command)
            row = world.observe().images["thermal_c"][40]
        return int(np.count_nonzero((row > 23.5) & (row < 30.0)))

    still, driving = width_of_edge((0.0, 0.0), 1, 0.0), width_of_edge((0.5, 0.0), 10, 0.0)
    turning = width_of_edge((0.0, 2.5), 12, -60.0)
    assert driving <= still + 1
    # 2.5 rad/s for 12 ms at 148 px focal length: 4.5 px.
    assert still + 2 <= turning <= still + 6


def test_both_renderers_give_nearly_the_same_thermal_image() -> None:
    images = {}
    for name in ("raycast", "bullet"):
        with SimulatedWorld(
            config(*WALKERS, robot=robot(camera=Pinhole(), thermal=NO_NOISE), renderer=name)
        ) as world:
            world.step(0.1, 0.1)
            images[name] = world.observe().images["thermal_c"]
    difference = np.abs(images["raycast"] - images["bullet"])
    assert np.median(difference) < 0.02
    # Outlines may differ by a pixel.
    assert np.mean(difference > 0.5) < 0.02


def fingerprints(seed: int) -> list[str]:
    """Digests of all that a world gives in 20 ticks, one a tick."""
    digests = []
    with SimulatedWorld(config(*WALKERS, robot=robot(camera=Pinhole()), seed=seed)) as world:
        for _ in range(20):
            senses, truth = world.observe(), world.truth()
            arrays = [
                senses.images["thermal"],
                senses.images["thermal_c"],
                senses.images["colour"],
                senses.sonar_m,
            ]
            arrays += [truth.instance, truth.body_part, truth.depth_m, *(p.joints_m for p in truth.people)]
            rest = [(p.box, p.whole_box, p.hidden_by, p.position_m) for p in truth.people]
            digest = hashlib.sha256(repr((senses.odometry, truth.robot, rest)).encode())
            for array in arrays:
                digest.update(array.tobytes())
            digests.append(digest.hexdigest())
            world.step(0.4, 0.3)
    return digests


@pytest.mark.thorough
def test_a_seed_gives_the_same_bytes_in_a_fresh_process_and_another_seed_does_not() -> None:
    here = fingerprints(3)
    program = "from tests.sim.test_world import fingerprints; print(*fingerprints(3))"
    environment = {**os.environ, "PYTHONPATH": ":".join(sys.path), "PYTHONHASHSEED": "7"}
    run = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
    )
    assert run.stdout.split() == here
    assert set(fingerprints(4)).isdisjoint(here)


def test_worlds_that_are_open_at_once_do_not_disturb_each_other() -> None:
    def fingerprint(world: SimulatedWorld) -> bytes:
        senses = world.observe()
        return (
            senses.images["thermal_c"].tobytes()
            + senses.images["colour"].tobytes()
            + senses.sonar_m.tobytes()
        )

    settings = config(*WALKERS)
    with SimulatedWorld(settings) as alone:
        expected = []
        for _ in range(6):
            alone.step(0.5, 0.2)
            expected.append(fingerprint(alone))
    with (
        SimulatedWorld(settings) as one,
        SimulatedWorld(config(WALKERS[0], seed=5)) as other,
        SimulatedWorld(settings) as third,
    ):
        for k in range(6):
            other.step(-0.5, 1.0)
            one.step(0.5, 0.2)
            other.observe()
            third.step(0.5, 0.2)
            assert fingerprint(one) == fingerprint(third) == expected[k]


def test_observing_and_asking_for_the_truth_changes_nothing_in_the_world() -> None:
    with SimulatedWorld(config(*WALKERS)) as watched, SimulatedWorld(config(*WALKERS)) as left_alone:
        for _ in range(10):
            watched.observe()
            watched.truth()
            for world in (watched, left_alone):
                world.step(0.5, 0.5)
        assert watched.truth().robot == left_alone.truth().robot
        assert np.array_equal(watched.truth().instance, left_alone.truth().instance)


def test_closing_frees_the_world_and_a_failed_one_leaves_nothing_open() -> None:
    before = open_worlds()
    world = SimulatedWorld(config())
    assert open_worlds() == before + 1
    world.close()
    assert open_worlds() == before
    broken = Fixture(name="broken")
    with refused("'broken'"):
        SimulatedWorld(config(place=replace(hall(), fixtures=(*hall().fixtures, broken))))
    missing = Fixture(name="missing", urdf="no/such.urdf", material=Material(temperature_c=20.0))
    with refused("no/such.urdf"):
        SimulatedWorld(config(place=replace(hall(), fixtures=(*hall().fixtures, missing))))
    assert open_worlds() == before


@pytest.mark.parametrize("name", ["robot", "border", "floor", "ann", "a/b"])
def test_names_that_could_be_mistaken_are_refused(name: str) -> None:
    with refused(f"'{name}'"):
        SimulatedWorld(config(WALKERS[0], person(name, (5.0, 0.0))))


def test_a_control_step_must_be_a_whole_number_of_physics_steps() -> None:
    with refused("14 Hz", "240 Hz"):
        WorldConfig(place=hall(), control_hz=14)
    with refused("seed", -1):
        WorldConfig(place=hall(), seed=-1)
    with refused("'magic'", "raycast"), SimulatedWorld(config(renderer="magic")) as world:
        world.truth()


@pytest.mark.parametrize(
    ("settings", "shape"),
    [
        ({}, "capsules"),
        ({"detail": "full"}, "skins"),
        ({"detail": "full", "renderer": "bullet"}, "capsules"),
        ({"detail": "full", "bodies": "capsules"}, "capsules"),
        ({"bodies": "skins"}, "skins"),
    ],
)
def test_people_have_skins_in_full_detail_unless_capsules_are_set(
    settings: dict[str, Any], shape: str
) -> None:
    with SimulatedWorld(config(*WALKERS, robot=robot(thermal=QUIET), **settings)) as world:
        assert world.config.body_shape == shape
        assert (world._scene.skins is not None) == (shape == "skins")
    with refused("bullet", "skins", "capsules"):
        config(*WALKERS, renderer="bullet", bodies="skins")


def test_a_command_that_is_no_number_is_refused_and_moves_nothing() -> None:
    with SimulatedWorld(config()) as world:
        with pytest.raises(BadInput, match="finite"):
            world.step(math.nan, 0.0)
        assert world.time_s == 0.0


def test_its_own_body_is_not_in_the_robot_s_default_cameras() -> None:
    with SimulatedWorld(WorldConfig(place=hall(), robot=RobotConfig(at_m=(3.0, 0.0)))) as world:
        keys = world.physics.parts()
        own = [k for k, key in enumerate(keys) if key.name == "robot"]
        for command in [(0.0, 0.0), (0.8, 2.6), (-0.8, -2.6)]:
            for _ in range(8):
                world.step(*command)
                for camera in world.config.robot.cameras.values():
                    assert not np.isin(world._see(camera).view.part, own).any()


def test_time_goes_by_control_steps_and_people_are_where_their_script_says() -> None:
    with SimulatedWorld(config(person("ann", (4.0, 0.0), (9.0, 0.0)))) as world:
        assert world.time_s == 0.0
        assert world.truth().people[0].position_m == (4.0, 0.0)
        for _ in range(45):
            world.step(0.0, 0.0)
        assert world.time_s == pytest.approx(3.0)
        # Up to 1.2 m/s at 1 m/s2: 3 s later she has come 1.2 * (3 - 0.6) m.
        assert world.truth().people[0].position_m == pytest.approx((6.88, 0.0), abs=0.06)


def test_what_the_cameras_see_is_where_the_truth_says() -> None:
    with SimulatedWorld(config(*WALKERS)) as world:
        for _ in range(20):
            world.step(0.4, 0.3)
            truth = world.truth()
            for somebody in truth.people:
                if somebody.visible_fraction == 1.0:
                    u, v = np.nanmean(somebody.joints_px, axis=0)
                    left, top, width, height = somebody.visible_box
                    assert left < u < left + width
                    assert top < v < top + height


def test_a_person_who_walks_on_past_a_robot_that_comes_from_the_side_pushes_it() -> None:
    path = (Waypoint(at_m=(1.9, 0.9)), Waypoint(at_m=(9.0, 0.9), speed_m_s=0.5))
    walker = PersonConfig(name="walker", path=path)
    with SimulatedWorld(config(walker, robot=robot(1.5, 0.0, heading_deg=30.0))) as world:
        contacts, tilts = [], []
        for _ in range(60):
            world.step(0.8, 0.0)
            contacts.append(world.truth().contacts)
            tilts.append(world.robot.world_from_robot()[2, 2])
    assert set(contacts) == {(), ("walker",)}
    assert contacts[0] == ()
    assert min(tilts) > math.cos(math.radians(3.0))


def test_a_person_who_appears_inside_the_robot_is_solid_once_they_are_apart() -> None:
    with SimulatedWorld(config(person("ann", (1.1, 0.1), enter_s=0.2), robot=robot(1.0))) as world:
        for _ in range(8):
            world.step(0.0, 0.0)
        assert world.truth().people[0].name == "ann"
        assert world.truth().contacts == ()
        assert world.truth().robot.x == pytest.approx(1.0, abs=0.01)
        for _ in range(30):
            world.step(-0.5, 0.0)
        assert world.truth().robot.x < 0.5
        for _ in range(60):
            world.step(0.5, 0.0)
        assert world.truth().contacts == ("ann",)
        assert world.truth().robot.x < 1.1 - 0.2


def test_a_robot_that_drives_into_a_person_touches_it_and_is_stopped() -> None:
    with SimulatedWorld(config(person("ann", (3.0, 0.0)))) as world:
        contacts = []
        for _ in range(75):
            world.step(0.5, 0.0)
            contacts.append(world.truth().contacts)
        assert contacts[0] == ()
        assert contacts[-1] == ("ann",)
        assert world.truth().robot.x < 3.0 - 0.21 - 0.1
        assert world.observe().sonar_m[3:5].max() < 0.25
