from functools import partial
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.wrappers import FrameStackObservation

import peopleboy  # noqa: F401  # tells gymnasium the environments
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.observations import Normaliser, observation_space
from peopleboy.sim.robot.robot_config import RobotConfig

ROBOT = RobotConfig()
SHORT = "name: short\ndescription: So short that it ends.\nlike: crossing_3\nduration_s: 0.4\n"


def told(*people: tuple[float, ...], **numbers: Any) -> dict[str, np.ndarray]:
    """An observation with these people, and nothing else to tell unless said."""
    rows = [*people, *[(0.0,) * 7] * (5 - len(people))]
    usual = {"sonar": np.full(16, 5.0, np.float32), "odometry": np.zeros(6, np.float32)}
    told = usual | {"tracks": np.array(rows, np.float32).reshape(-1)} | numbers
    return {name: array[None] for name, array in told.items()}


def rows(observation: dict[str, np.ndarray]) -> list[list[float]]:
    return np.round(observation["tracks"].reshape(5, 7).astype(float), 4).tolist()


def normalised(holders: np.ndarray, observation: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {name: array[0] for name, array in Normaliser(ROBOT)(observation, holders).items()}


def test_every_entry_is_its_share_of_what_becomes_one_and_clipped_beyond() -> None:
    found = normalised(
        np.zeros((1, 5)),
        told(
            (900_000.0, -0.5, 0.6, 0.2, 0.8, 0.9, 1.0),
            (7.0, 3.0, 3.0, -5.0, 5.0, 0.5, 0.0),
            sonar=np.linspace(0.5, 8.0, 16, dtype=np.float32),
            odometry=np.array([5.0, -40.0, 0.6, -0.8, -0.4, 9.0], np.float32),
        ),
    )
    assert found["sonar"] == pytest.approx(np.minimum(np.linspace(0.1, 1.6, 16), 1.0))
    assert found["odometry"] == pytest.approx([0.25, -1.0, 0.6, -0.8, -0.5, 1.0])
    assert rows(found)[0] == pytest.approx([1.0, -0.5, 0.3, 0.1, 0.4, 0.9, 1.0])
    assert rows(found)[1] == [1.0, 1.0, 1.0, -1.0, 1.0, 0.5, 0.0]
    assert not np.any(rows(found)[2:])
    assert Normaliser(ROBOT).space(observation_space("tracks", ROBOT, ())).contains(found)


def test_whoever_has_a_row_keeps_it_and_newcomers_take_the_first_that_is_free() -> None:
    holders = np.zeros((1, 5))
    (a, b, c) = ((float(n), n / 10.0, 0.5, 0.2, 0.7, 1.0, 1.0) for n in (1, 2, 3))
    columns = [
        [row[1] for row in rows(normalised(holders, told(*people)))][:3]
        for people in ((a, b), (b, a), (c, b), (c, a, b), ())
    ]
    assert columns == [[0.1, 0.2, 0], [0.1, 0.2, 0], [0.3, 0.2, 0], [0.3, 0.2, 0.1], [0, 0, 0]]
    assert rows(normalised(np.zeros((1, 5)), told(b)))[0][1] == 0.2


@pytest.mark.parametrize("kind", ["truth", "pixels"])
def test_environments_of_one_and_of_many_worlds_give_it_and_leave_images_alone(
    kind: str, tmp_path: Path
) -> None:
    scene = tmp_path / "short.yaml"
    scene.write_text(SHORT)
    settings = {"scenario": scene, "observation": kind, "physics": "kinematic", "image_size": (64, 48)}
    one = gymnasium.make("peopleboy/PersonFollowing-v0", normalise=True, **settings)
    many = gymnasium.make_vec(
        "peopleboy/PersonFollowing-v0",
        num_envs=2,
        vectorization_mode="vector_entry_point",
        normalise=True,
        **settings,
    )
    first, _ = many.reset(seed=1)
    raw, seen = PeopleBoyEnv(**settings).reset(seed=1)[0], one.reset(seed=1)[0]
    assert one.observation_space.contains(seen)
    assert all(np.array_equal(array, first[name][0]) for name, array in seen.items())
    assert seen["sonar"] == pytest.approx(raw["sonar"] / 5.0)
    for name in set(raw) - {"sonar", "odometry", "tracks"}:
        assert np.array_equal(raw[name], seen[name])
        assert one.observation_space[name].dtype == np.uint8
    for name in set(raw) & {"sonar", "odometry", "tracks"}:
        box = one.observation_space[name]
        assert box.low.min() >= -1.0
        assert box.high.max() == 1.0
    one.close()
    many.close()


def test_gymnasium_stacks_images_of_one_world_and_of_many(tmp_path: Path) -> None:
    scene = tmp_path / "short.yaml"
    scene.write_text(SHORT)
    settings = {"scenario": scene, "observation": "pixels", "physics": "kinematic", "image_size": (64, 48)}
    stack = partial(FrameStackObservation, stack_size=3)
    one = stack(gymnasium.make("peopleboy/PersonFollowing-v0", **settings))
    many = gymnasium.make_vec(
        "peopleboy/PersonFollowing-v0", 2, vectorization_mode="sync", wrappers=(stack,), **settings
    )
    plain = PeopleBoyEnv(**settings)
    images = [plain.reset(seed=4)[0]["thermal"], *(plain.step((0.3, 0.5))[0]["thermal"] for _ in range(3))]
    one.reset(seed=4)
    many.reset(seed=4)
    for _ in range(3):
        stacked = one.step(np.array((0.3, 0.5), np.float32))[0]["thermal"]
        of_many = many.step(np.full((2, 2), (0.3, 0.5), np.float32))[0]["thermal"]
    assert np.array_equal(stacked, images[1:])
    assert np.array_equal(of_many[0], stacked)
    assert of_many.shape == (2, 3, 48, 64, 1)
    one.close()
    many.close()
