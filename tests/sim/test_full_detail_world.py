"""A world of full detail: what it changes, and what it must not."""

from dataclasses import replace

import numpy as np
import pytest

from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from tests.helpers.worlds.small_worlds import config, person

IMAGES = ("thermal_c", "colour")


def world_config(shine: float, detail: str = "full") -> WorldConfig:
    plain = config(person("anna", (5.0, 0.3)), person("ben", (6.0, -0.5)))
    fixtures = tuple(
        replace(one, part=replace(one.part, material=replace(one.part.material, shine=shine)))
        if one.name == "floor" and one.part is not None
        else one
        for one in plain.place.fixtures
    )
    return replace(plain, detail=detail, place=replace(plain.place, fixtures=fixtures))


def shot(config: WorldConfig) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray]:
    """The images, the masks and the depths of the second instant."""
    with SimulatedWorld(config) as world:
        world.step(0.0, 0.0)
        images, truth = world.observe().images, world.truth()
        return {name: images[name] for name in IMAGES}, truth.instance, truth.depth_m


def test_the_same_world_of_full_detail_gives_the_same_bytes() -> None:
    one, other = shot(world_config(0.8)), shot(world_config(0.8))
    assert all(np.array_equal(one[0][name], other[0][name]) for name in IMAGES)


def test_a_mirror_changes_both_images_and_no_truth() -> None:
    dull, shiny = shot(world_config(0.0)), shot(world_config(1.0))
    assert np.array_equal(dull[1], shiny[1])
    assert np.array_equal(dull[2], shiny[2])
    for name in IMAGES:
        differs = dull[0][name] != shiny[0][name]
        where = differs.any(axis=-1) if differs.ndim == 3 else differs
        assert 20 < np.count_nonzero(where) < 0.5 * where.size


def test_in_plain_detail_nothing_shines() -> None:
    dull, shiny = shot(world_config(0.0, "plain")), shot(world_config(1.0, "plain"))
    assert all(np.array_equal(dull[0][name], shiny[0][name]) for name in IMAGES)


def test_people_are_mirrored_warm() -> None:
    dull, shiny = shot(world_config(0.0)), shot(world_config(1.0))
    warmer = shiny[0]["thermal_c"].astype(float) - dull[0]["thermal_c"]
    assert warmer.max() > 0.3
    assert warmer.min() > -0.3


@pytest.mark.slow
@pytest.mark.parametrize("name", IMAGES)
def test_full_detail_smooths_people_s_edges(name: str) -> None:
    plain, full = shot(world_config(0.0, "plain")), shot(world_config(0.0))
    assert np.count_nonzero(plain[0][name] != full[0][name]) > 50
