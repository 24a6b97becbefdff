"""Installed from a wheel, outside the repository: what a user gets. It needs a package index."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pyarrow.parquet as pq
import pytest

from tests.helpers.import_graph import ROOT
from tests.helpers.pages import DOCS, blocks

pytestmark = pytest.mark.install

NEWER = ("python3.13", "python3.12")
ROOMS = ("behaviours", "geometry", "scenarios", "sim", "studies", "tracker")
CONSTRAINTS = ROOT / "constraints.txt"


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What git knows of this checkout, so that nothing else gets in."""
    folder = tmp_path_factory.mktemp("source")
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout
    for name in filter(None, listed.split("\0")):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, folder / name, follow_symlinks=False)
    return folder


@pytest.fixture(scope="module")
def wheel(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(source, tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A user's own folder, with files of names that an ill-kept package would trip over."""
    folder = tmp_path_factory.mktemp("home")
    for name in ("geometry", "sim", "tracker", "behaviours", "scenarios", "studies", "bad_input"):
        (folder / f"{name}.py").write_text(
            "raise ImportError('this one is the user\\'s')\n", encoding="utf-8"
        )
    return folder


@pytest.fixture(scope="module")
def whole(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The programs of an environment with everything that the wheel asks for, and what recordings need."""
    return environment(sys.executable, f"{wheel}[viewer]", tmp_path_factory.mktemp("whole"))


@pytest.fixture(scope="module")
def without_pybullet(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The programs of an environment without PyBullet and without rerun."""
    programs = environment(newer_python() or sys.executable, str(wheel), tmp_path_factory.mktemp("without"))
    gone = ["pybullet", "pybullet-arm64"]
    subprocess.run([programs / "pip", "uninstall", "--quiet", "--yes", *gone], check=True)
    return programs


@pytest.fixture(scope="module")
def finished(whole: Path, home: Path) -> Path:
    """A run with its frames."""
    assert call(whole, home, "run", "crossing_pair", "--frames", "--out", "run").returncode == 0
    return home / "run"


def pip(python: str | Path, *arguments: str) -> None:
    command = [str(python), "-m", "pip", "--quiet", "--disable-pip-version-check", *arguments]
    subprocess.run(command, check=True, timeout=900)


def build(source: Path, folder: Path) -> Path:
    pip(sys.executable, "wheel", "--no-deps", "--wheel-dir", str(folder), str(source))
    return next(folder.glob("*.whl"))


def newer_python() -> str | None:
    """A newer Python than 3.11: on the path, or one of pyenv's."""
    on_path = [path for name in NEWER if (path := shutil.which(name))]
    of_pyenv = [str(path) for path in sorted(Path.home().glob(".pyenv/versions/3.1[23].*/bin/python"))]
    for path in [*on_path, *of_pyenv]:
        if subprocess.run([path, "-c", ""], capture_output=True, check=False).returncode == 0:
            return path
    return None


def environment(python: str, wheel: str, folder: Path) -> Path:
    subprocess.run([python, "-m", "venv", str(folder)], check=True)
    pip(folder / "bin" / "python", "install", "--constraint", str(CONSTRAINTS), wheel)
    return folder / "bin"


def call(programs: Path, cwd: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return run([str(programs / "peopleboy"), *arguments], cwd)


def run(command: list[str], cwd: Path) -> subprocess.CompletedProcess[str]:
    clean = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "VIRTUAL_ENV")}
    return subprocess.run(
        command, cwd=cwd, env=clean, capture_output=True, text=True, check=False, timeout=600
    )


def test_the_wheel_works_beside_a_users_own_modules_of_the_same_names(whole: Path, home: Path) -> None:
    done = call(
        whole, home, "run", "crossing_pair", "--tracker", "learned", "--no-recording", "--out", "learned"
    )
    assert done.returncode == 0, done.stderr
    assert (home / "learned" / "metrics.json").is_file()


def test_a_tracker_a_controller_and_tracks_of_ones_own_go_through_everything_from_an_empty_folder(
    whole: Path, tmp_path: Path
) -> None:
    path = os.pathsep.join([str(whole), os.environ["PATH"]])
    for block in blocks(DOCS / "guides" / "own-tracker.md"):
        if block.title:
            (tmp_path / block.title).write_text(block.code, encoding="utf-8")
            continue
        program = ["python", "-c"] if block.language == "python" else ["bash", "-euc"]
        done = run(["env", f"PATH={path}", *program, block.code], tmp_path)
        assert done.returncode == 0, f"{block.where}: {done.stderr}"
    for name in ("one", "both", "warmest"):
        assert (tmp_path / "runs" / name / "recording.rrd").is_file()


def test_the_studies_find_their_tables_in_the_wheel(whole: Path, home: Path) -> None:
    done = call(whole, home, "reproduce", "--list")
    assert done.returncode == 0, done.stderr
    assert "3.1" in done.stdout


def test_the_environment_is_made_by_its_name(whole: Path, home: Path) -> None:
    code = (
        "import gymnasium, peopleboy\n"
        "env = gymnasium.make('peopleboy/PersonFollowing-v0', observation='truth')\n"
        "print(gymnasium.__version__, sorted(env.reset(seed=3)[0]))"
    )
    done = run([str(whole / "python"), "-W", "error", "-c", code], home)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[0] >= "1"


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["list"],
        ["show", "crossing_2"],
        ["schema"],
        ["reproduce", "--list"],
        ["evaluate", "run"],
        ["report", "run", "--out", "report.html"],
        ["track", "run/thermal", "--out", "tracked"],
        ["export", "run", "--format", "viper", "--out", "viper"],
        ["export", "run", "--format", "mot", "--out", "mot"],
        ["run", "crossing_2", "--out", "kinematic"],
        ["sweep", "crossing_2", "--seeds", "2", "--out", "swept"],
        ["render", "crossing_pair", "--seeds", "2", "--out", "set"],
    ],
    ids=" ".join,
)
def test_what_needs_no_pybullet_works_without_it(
    without_pybullet: Path, finished: Path, home: Path, arguments: list[str]
) -> None:
    assert finished.is_dir()
    done = call(without_pybullet, home, *arguments)
    assert done.returncode == 0, done.stderr


def test_what_is_missing_is_said_in_a_line(without_pybullet: Path, home: Path) -> None:
    done = call(without_pybullet, home, "run", "crossing_pair", "--out", "lacking")
    assert done.returncode == 0, done.stderr
    assert [line for line in done.stderr.splitlines() if line.startswith("peopleboy: note:")] == [
        "peopleboy: note: PyBullet is not installed; physics is kinematic",
        "peopleboy: note: no recording is written: needs rerun: pip install 'peopleboy[viewer]'",
    ]
    assert not (home / "lacking" / "recording.rrd").exists()


@pytest.mark.parametrize(
    ("arguments", "missing"),
    [
        (["run", "crossing_2", "--physics", "bullet"], "PyBullet"),
        (["sweep", "crossing_2", "--seeds", "2", "--physics", "bullet"], "PyBullet"),
        (["export", "run", "--format", "coco", "--out", "coco"], "PyBullet"),
        (["view", "run"], "peopleboy[viewer]"),
        (["run", "crossing_2", "--live"], "peopleboy[viewer]"),
    ],
    ids=str,
)
def test_what_needs_a_missing_package_says_so_in_a_line_and_leaves_nothing(
    without_pybullet: Path, finished: Path, home: Path, arguments: list[str], missing: str
) -> None:
    assert finished.is_dir()
    before = sorted(home.rglob("*"))
    done = call(without_pybullet, home, *arguments)
    assert done.returncode == 2
    *notices, line = done.stderr.splitlines()
    assert missing in line
    assert not notices or "bullet" not in arguments
    assert sorted(home.rglob("*")) == before


def test_an_archive_without_symbolic_links_gives_the_same_wheel(
    source: Path, wheel: Path, tmp_path: Path
) -> None:
    shutil.copytree(source, tmp_path / "source", symlinks=True)
    for room in ROOMS:
        link = tmp_path / "source" / "src" / "peopleboy" / room
        link.unlink()
        link.write_text(f"../../{room}", encoding="utf-8")  # as git on Windows leaves it

    other = build(tmp_path / "source", tmp_path / "wheel")

    contents = [{e.filename: e.CRC for e in ZipFile(path).infolist()} for path in (wheel, other)]
    for content in contents:
        content.pop("peopleboy-0.1.0.dist-info/RECORD")
    assert contents[0] == contents[1]


def test_two_numpy_versions_give_the_same_bytes(wheel: Path, home: Path, tmp_path: Path) -> None:
    python = newer_python()
    if python is None:
        pytest.skip("NumPy 2.5 needs Python 3.12 or newer")
    programs, found = environment(python, str(wheel), tmp_path / "environment"), []
    for version in ("2.4.*", "2.5.*"):
        pip(programs / "python", "install", f"numpy=={version}")
        out = tmp_path / version
        done = call(programs, home, "run", "single_follow", "--seed", "1", "--out", str(out))
        assert done.returncode == 0, done.stderr
        tables = sorted(out.rglob("*.parquet"))
        found.append([(path.name, pq.read_table(path).to_pylist()) for path in tables])
    assert str(found[0]) == str(found[1])
