"""What is installed, by which Python on which system, and that all files that say so agree."""

import os
import re
import runpy
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement

from tests.helpers.import_graph import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
ROOMS = ("behaviours", "geometry", "scenarios", "sim", "studies", "tracker")
ACTION = re.compile(r"uses: [\w./-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+$")


def environment(python: str, platform: str, machine: str) -> dict[str, str]:
    return {"python_version": python, "sys_platform": platform, "platform_machine": machine}


@pytest.mark.parametrize("python", ["3.11", "3.12", "3.13"])
@pytest.mark.parametrize(
    "system", [("linux", "x86_64"), ("darwin", "arm64"), ("darwin", "x86_64"), ("win32", "AMD64")]
)
def test_exactly_one_pybullet_is_installed(python: str, system: tuple[str, str]) -> None:
    where = environment(python, *system)
    found = [
        r.name
        for r in map(Requirement, PROJECT["dependencies"])
        if r.marker is None or r.marker.evaluate(where)
    ]

    assert len([name for name in found if name.startswith("pybullet")]) == 1


@pytest.mark.parametrize(
    "where", [environment("3.14", "linux", "x86_64"), environment("3.12", "linux", "aarch64")]
)
def test_no_pybullet_is_compiled_where_it_has_no_wheel(where: dict[str, str]) -> None:
    names = [
        r.name
        for r in map(Requirement, PROJECT["dependencies"])
        if r.marker is None or r.marker.evaluate(where)
    ]

    assert not [name for name in names if name.startswith("pybullet")]


def layout(folder: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[set[str], dict[str, str]]:
    given: dict[str, object] = {}
    monkeypatch.setattr("setuptools.setup", lambda **settings: given.update(settings))
    monkeypatch.chdir(folder)
    runpy.run_path(str(folder / "setup.py"))
    return set(given["packages"]), given["package_dir"]


def test_the_same_packages_are_found_where_symbolic_links_are_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    linked, _ = layout(ROOT, monkeypatch)
    without_caches = shutil.ignore_patterns("__pycache__", *ROOMS)
    shutil.copytree(ROOT / "src", tmp_path / "src", ignore=without_caches)
    shutil.copy(ROOT / "setup.py", tmp_path)
    for room in ROOMS:
        shutil.copytree(ROOT / room, tmp_path / room, ignore=shutil.ignore_patterns("__pycache__"))
        (tmp_path / "src" / "peopleboy" / room).write_text(f"../../{room}")  # as git on Windows leaves it

    found, folders = layout(tmp_path, monkeypatch)

    assert found == linked
    assert folders["peopleboy.sim"] == "sim"


def test_an_incomplete_archive_is_refused_in_one_line(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "src", tmp_path / "src", ignore=shutil.ignore_patterns("__pycache__", *ROOMS))
    shutil.copy(ROOT / "setup.py", tmp_path)
    done = subprocess.run(
        [sys.executable, "setup.py", "--version"], cwd=tmp_path, capture_output=True, text=True, check=False
    )

    assert done.returncode == 1
    assert done.stderr.splitlines() == [
        "peopleboy cannot be built: the folder behaviours/ is missing beside setup.py; "
        "take the whole archive or a clone"
    ]


def test_constraints_are_those_of_the_lock_file() -> None:
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])  # where uv is
    made = subprocess.run(
        [ROOT / ".ci" / "constraints"],
        env=os.environ | {"PATH": path},
        capture_output=True,
        text=True,
        check=True,
    ).stdout

    assert made == (ROOT / "constraints.txt").read_text(encoding="utf-8"), "`make lock` writes both"


def test_actions_are_pinned_and_jobs_have_only_the_rights_that_they_need() -> None:
    for path in sorted((ROOT / ".github" / "workflows").glob("*.yml")):
        text = path.read_text(encoding="utf-8")
        used = [line.strip(" -") for line in text.splitlines() if "uses:" in line]
        assert used
        assert not [line for line in used if not ACTION.fullmatch(line)], path.name
        assert yaml.safe_load(text)["permissions"] == {}, path.name


def test_version_and_addresses_stand_in_one_place() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    recipe = (ROOT / "conda.recipe" / "recipe.yaml").read_text(encoding="utf-8")
    assert citation["version"] == PROJECT["version"]
    assert f"version: {PROJECT['version']}\n" in recipe
    placeholder = PROJECT["urls"]["Homepage"].removeprefix("https://")
    found = subprocess.run(
        ["git", "grep", "-l", placeholder], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert found.stdout.split() == ["pyproject.toml"]


def test_the_conda_recipe_asks_for_what_the_package_does() -> None:
    conda = {"matplotlib": "matplotlib-base", "msgpack": "msgpack-python"} | {
        "opencv-python-headless": "opencv"
    }
    own = {Requirement(line) for line in PROJECT["dependencies"]}
    wanted = {f"{conda.get(r.name, r.name)}{r.specifier}" for r in own if r.name != "pybullet-arm64"}
    recipe = (ROOT / "conda.recipe" / "recipe.yaml").read_text(encoding="utf-8")
    run = recipe[recipe.index("  run:\n") : recipe.index("\ntests:")]
    given = {line.removeprefix("    - ").replace(" ", "") for line in run.splitlines()[1:]}

    assert {_sorted(line) for line in given} == {_sorted(line) for line in wanted | {"python>=3.11"}}


def _sorted(line: str) -> tuple[str, ...]:
    return tuple(sorted(str(Requirement(line)).split(",")))
