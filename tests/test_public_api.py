import re
import subprocess
import sys
import typing
from importlib import import_module
from pathlib import Path

import pytest

import peopleboy
from tests.helpers.import_graph import ROOT
from tests.helpers.pages import blocks


def run_python(code: str) -> str:
    command = [sys.executable, "-W", "error", "-c", code]
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=60).stdout


def test_every_public_name_is_that_of_its_home() -> None:
    assert set(peopleboy.__all__) <= set(peopleboy._HOMES)
    for name, home in peopleboy._HOMES.items():
        assert getattr(peopleboy, name) is getattr(import_module(f"peopleboy.{home}"), name)


def test_type_checkers_are_told_the_same_homes_as_the_interpreter() -> None:
    source = Path(peopleboy.__file__).read_text(encoding="utf-8")
    told = dict.fromkeys(peopleboy._HOMES, "")
    namespace: dict[str, typing.Any] = {}
    block = source.split("if TYPE_CHECKING:\n")[1].split("\n\n")[0]
    exec("\n".join(line.strip() for line in block.splitlines()), namespace)
    assert {name: namespace[name] for name in told} == {name: getattr(peopleboy, name) for name in told}


HEAVY = ("numba", "pybullet", "scipy", "cv2", "rerun", "matplotlib", "pydantic", "peopleboy.sim")
WHAT_IS_LOADED = f"import sys; print([name for name in {HEAVY} if name in sys.modules])"


def test_importing_it_loads_none_of_the_heavy_packages() -> None:
    assert run_python(f"import peopleboy; {WHAT_IS_LOADED}").strip() == "[]"


def test_the_help_of_the_command_line_loads_none_of_them_either() -> None:
    shows_help = "from peopleboy.scenarios.cli import cli; cli(['--help'], standalone_mode=False)"
    *told, loaded = run_python(f"{shows_help}; {WHAT_IS_LOADED}").strip().splitlines()
    assert any("reproduce" in line for line in told)
    assert loaded == "[]"


def test_a_name_that_is_not_there_is_refused_as_modules_do() -> None:
    told = run_python("import peopleboy; print(hasattr(peopleboy, 'nothing_of_that_name'))")
    assert told.strip() == "False"


def test_the_page_on_the_package_names_each_of_them() -> None:
    page = (ROOT / "docs" / "reference" / "python.md").read_text(encoding="utf-8")
    rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("| [`")]
    told = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    assert told == set(peopleboy._HOMES)


def test_dir_and_a_star_import_give_the_names_to_start_with() -> None:
    assert dir(peopleboy) == sorted([*peopleboy.__all__, "__version__"])
    assert len(peopleboy.__all__) == 13
    page = (ROOT / "docs" / "reference" / "python.md").read_text(encoding="utf-8")
    start = page.split("## From a world to scores")[1].split("```")[1]
    used = {name for name in peopleboy.__all__ if re.search(rf"\b{name}\b", start)}
    assert {"World", "Frame", "make_tracker", "TrackBoxes", "TrueBoxes", "evaluate"} <= used


@pytest.mark.thorough
def test_the_examples_on_the_page_pass_the_strict_checks_of_mypy(tmp_path: Path) -> None:
    page = ROOT / "docs" / "reference" / "python.md"
    code = [block.code for block in blocks(page) if block.language == "python"]
    files = [tmp_path / f"example_{number}.py" for number in range(len(code))]
    for file, text in zip(files, code, strict=True):
        file.write_text(text, encoding="utf-8")
    options = (
        "--strict",
        "--config-file",
        "/dev/null",
        "--cache-dir",
        str(tmp_path),
        "--follow-imports=silent",
    )
    command = [sys.executable, "-m", "mypy", *options, *map(str, files)]
    checked = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=600)
    assert checked.returncode == 0, checked.stdout
