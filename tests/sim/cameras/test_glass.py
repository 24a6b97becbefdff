"""Glass blocks heat and passes light: each camera, and its truth, sees what its sensor can see."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.vector_environment import PeopleBoyVectorEnv
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.world import SimulatedWorld

GLASS = {"kind": "glass_wall", "at_m": [3.0, 0.0], "size_m": [0.08, 4.0, 2.4], "temperature_c": 18.0}
SCENE: dict[str, Any] = {
    "name": "behind_glass",
    "description": "A person stands behind a glass wall.",
    "duration_s": 1.0,
    "place": {"kind": "room", "length_m": 9.0, "width_m": 6.0},
    "people": [{"name": "anna", "path": [{"at_m": [5.0, 0.3]}]}],
    "things": [GLASS],
    "robot": {
        "at_m": [0.6, 0.0],
        "cameras": {"thermal": {"kind": "thermal"}, "colour": {"kind": "colour"}, "depth": {"kind": "depth"}},
    },
}


def world(folder: Path, renderer: str = "raycast", **changes: Any) -> SimulatedWorld:
    path = folder / "behind_glass.yaml"
    path.write_text(yaml.safe_dump(SCENE | changes), encoding="utf-8")
    return SimulatedWorld(load_scenario(path).world(1, renderer))


@pytest.mark.parametrize("changes", [{}, {"detail": "full"}, {"physics": "kinematic"}])
def test_people_behind_glass_are_in_colour_and_depth_but_not_in_thermal(
    tmp_path: Path, changes: dict[str, Any]
) -> None:
    with world(tmp_path, **changes) as glass, world(tmp_path, things=[], **changes) as free:
        (thermal,), (colour,), (depth,) = (
            glass.truth(name).people for name in ("thermal", "colour", "depth")
        )
        (unhidden,) = free.truth("colour").people
        left, top, width, height = map(round, colour.visible_box)
        person = np.s_[top : top + height, left : left + width]
        ours, theirs = (each.observe().images["colour"][person].astype(int) for each in (glass, free))
    assert thermal.visible_px == 0
    assert max(thermal.hidden_by, key=thermal.hidden_by.get) == "glass_wall_1"
    for one in (colour, depth):
        assert one.visible_px > 0.95 * unhidden.visible_px
        assert "glass_wall_1" not in one.hidden_by
    assert np.abs(ours - theirs).mean() < 12.0
    assert colour.joint_is_visible.any()
    assert not thermal.joint_is_visible.any()


def test_a_pane_has_its_own_temperature_in_thermal_and_no_depth(tmp_path: Path) -> None:
    with world(tmp_path) as glass:
        observed = glass.observe().images
        images = {name: observed[name] for name in ("depth", "thermal_c")}
        box = glass.truth("depth").people[0].visible_box
    left, top, width, height = (round(edge) for edge in box)
    body = images["depth"][top + height // 4 : top + height // 2, left + 2 : left + width - 2]
    assert np.median(body[body > 0]) / 1000 == pytest.approx(4.4, abs=0.4)
    camera = load_scenario(tmp_path / "behind_glass.yaml").robot.config().cameras["thermal"].camera
    around = images["thermal_c"][camera.height // 2 - 10 : camera.height // 2 + 10]
    assert np.median(around[:, camera.width // 2 - 40 : camera.width // 2]) == pytest.approx(18.5, abs=1.5)


def test_depth_is_lost_where_a_camera_looks_through_glass_at_a_low_angle(tmp_path: Path) -> None:
    along = GLASS | {"at_m": [3.0, 0.5], "size_m": [0.04, 5.0, 2.4], "facing_deg": 90.0}
    people = [{"name": "anna", "path": [{"at_m": [4.0, 1.6]}]}]
    robot = SCENE["robot"] | {"heading_deg": 20.0}
    with world(tmp_path, things=[along], people=people, robot=robot) as glass:
        depth = glass.observe().images["depth"]
    with world(tmp_path, things=[], people=people, robot=robot) as free:
        unhidden = free.observe().images["depth"]
    assert (depth > 0).mean() < 0.8 * (unhidden > 0).mean()


@pytest.mark.slow
def test_the_reference_renderer_sees_through_glass_as_well(tmp_path: Path) -> None:
    pytest.importorskip("pybullet")
    with world(tmp_path, "bullet", physics="bullet") as glass:
        thermal, colour = (glass.truth(name).people[0] for name in ("thermal", "colour"))
    assert thermal.visible_px == 0
    assert colour.visible_px > 500


@pytest.mark.slow
def test_worlds_that_are_rendered_together_have_the_images_of_single_ones(tmp_path: Path) -> None:
    path = tmp_path / "behind_glass.yaml"
    cameras = {"thermal": {"kind": "thermal"}, "colour": {"kind": "colour"}}
    robot = SCENE["robot"] | {"cameras": cameras}
    path.write_text(yaml.safe_dump(SCENE | {"robot": robot}), encoding="utf-8")
    single = PeopleBoyEnv(path, observation="pixels", physics="kinematic")
    alone, _ = single.reset(seed=3)
    many = PeopleBoyVectorEnv(2, scenario=path, observation="pixels", physics="kinematic")
    together, _ = many.reset(seed=[3, 4])
    for name in ("thermal", "colour"):
        assert np.array_equal(alone[name], together[name][0]), name
