from __future__ import annotations

import copy
import shutil
from pathlib import Path
from typing import Any

import pytest
import yaml

from peopleboy.behaviours.behaviour import Command
from peopleboy.scenarios.export.replay import replay
from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.scenarios.running.frame_cache import film_key
from peopleboy.scenarios.running.run import is_finished, run
from peopleboy.scenarios.running.run_options import RunOptions
from tests.helpers.calls.refused import refused

CAMERA = {"width_px": 80, "height_px": 60}
SCENE: dict[str, Any] = {
    "name": "own_desk",
    "description": "A desk from files of its own.",
    "duration_s": 0.4,
    "place": {"kind": "room", "length_m": 8.0, "width_m": 6.0},
    "things": [{"kind": "urdf", "name": "desk", "urdf": "furniture/desk.urdf", "at_m": [4.0, 1.0]}],
    "people": [{"name": "anna", "path": [{"at_m": [5.0, 0.0]}, {"at_m": [6.0, 0.0], "speed_m_s": 1.0}]}],
    "robot": {
        "at_m": [0.6, 0.0],
        "cameras": {name: {"kind": name, **CAMERA} for name in ("thermal", "colour")},
    },
}
URDF = """<?xml version="1.0"?>
<robot name="desk"><link name="base">
  <visual><geometry><mesh filename="{mesh}"/></geometry></visual>
  <collision><geometry><mesh filename="meshes/coarse.obj"/></geometry></collision>
</link></robot>
"""
TETRAHEDRON = "mtllib {mtl}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
FILES = [
    "furniture/desk.urdf",
    *(f"furniture/meshes/{name}" for name in ("coarse.obj", "desk.mtl", "desk.obj", "wood.png")),
]


def furnish(home: Path, mesh: str = "meshes/desk.obj") -> Path:
    """Write a scenario with a desk; the scenario's path."""
    meshes = home / "furniture" / "meshes"
    meshes.mkdir(parents=True)
    (home / "furniture" / "desk.urdf").write_text(URDF.format(mesh=mesh))
    (meshes / "desk.obj").write_text(TETRAHEDRON.format(mtl="desk.mtl"))
    (meshes / "coarse.obj").write_text(TETRAHEDRON.format(mtl="missing.mtl"))
    (meshes / "desk.mtl").write_text("newmtl wood\nKd 1 0 0\nmap_Kd -s 1 1 wood.png\n")
    (meshes / "wood.png").write_bytes(b"grain")
    (home / "unrelated.txt").touch()
    (home / "scene.yaml").write_text(yaml.safe_dump(SCENE))
    return home / "scene.yaml"


def play(scenario: Scenario, folder: Path) -> Path:
    options = RunOptions(seed=0, out=folder, record=False, frames=True, overwrite=True)
    run(scenario, options, lambda *_: None)
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    """Return the bytes of all files but the times of updates, which differ."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name != "latency.txt"
    }


@pytest.mark.slow
@pytest.mark.parametrize("mesh", ["meshes/desk.obj", "package://furniture/meshes/desk.obj"])
def test_a_run_whose_furniture_is_gone_plays_again_from_its_folder_alone(mesh: str, tmp_path: Path) -> None:
    done = play(load_scenario(furnish(tmp_path / "home", mesh)), tmp_path / "run")
    shutil.rmtree(tmp_path / "home")
    assert set(FILES) <= contents(done).keys()
    assert "unrelated.txt" not in contents(done)
    assert len(list(replay(open_run(done)))) == 6
    again = play(load_scenario(done / "scenario.yaml"), tmp_path / "again")
    assert contents(again) == contents(done)


def test_a_run_can_be_replaced_by_its_own_scenario(tmp_path: Path) -> None:
    done = play(load_scenario(furnish(tmp_path / "home")), tmp_path / "run")
    before = contents(done)
    assert contents(play(load_scenario(done / "scenario.yaml"), done)) == before


def test_another_desk_of_the_same_name_makes_another_run_and_other_frames(tmp_path: Path) -> None:
    path = furnish(tmp_path / "home")
    scenario, options = load_scenario(path), RunOptions(seed=0, out=tmp_path / "run")
    play(scenario, options.out)
    assert is_finished(scenario, options)
    (path.parent / "furniture" / "meshes" / "desk.obj").write_text(TETRAHEDRON.format(mtl="other.mtl"))
    with refused(tmp_path / "run"):
        is_finished(load_scenario(path), options)
    assert film_key(load_scenario(path), 0) != film_key(scenario, 0)


def test_furniture_of_pybullet_is_not_copied(tmp_path: Path) -> None:
    data = copy.deepcopy(SCENE)
    data["things"][0]["urdf"] = "table/table.urdf"
    assert not parse_scenario(data, source="x.yaml", folder=tmp_path).kept_files()


def test_a_package_that_lies_outside_the_scenario_s_folder_is_refused(tmp_path: Path) -> None:
    path = furnish(tmp_path / "home", "package://elsewhere/desk.obj")
    shutil.copytree(path.parent / "furniture" / "meshes", tmp_path / "elsewhere")
    with refused("things[0].urdf: ", "elsewhere/desk.obj"):
        load_scenario(path)


def test_a_recorded_drive_is_kept_with_the_run_and_repeated_from_there(tmp_path: Path) -> None:
    data = SCENE | {"things": [], "robot": SCENE["robot"] | {"behaviour": "follow_person"}}
    drive = [Command(linear_m_s=0.1 * step, angular_rad_s=-0.3) for step in range(1, 5)]
    scenario = parse_scenario(data, source="x.yaml", folder=tmp_path).driven(drive)
    done = play(scenario, tmp_path / "run")
    again = load_scenario(done / "scenario.yaml")
    assert again.drive == tuple(drive)
    assert contents(play(again, tmp_path / "again")) == contents(done)
    assert again.steered_by("stand").drive is None
    (done / "drive.parquet").unlink()
    with refused("drive.parquet"):
        load_scenario(done / "scenario.yaml")
