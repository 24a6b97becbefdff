"""Installed from a wheel, outside the repository: what a user gets. It needs a package index."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.helpers.import_graph import ROOT
from tests.helpers.pages import DOCS, blocks

pytestmark = pytest.mark.install

# PyBullet has no wheels for these, so that nothing installs it there.
WITHOUT_WHEELS = ("python3.13", "python3.12")
CONSTRAINTS = ROOT / "constraints.txt"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of what git knows of this checkout, so that nothing else gets in."""
    source, folder = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("wheel")
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout
    for name in filter(None, listed.split("\0")):
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, source / name, follow_symlinks=False)
    pip(sys.executable, "wheel", "--no-deps", "--wheel-dir", str(folder), str(source))
    return next(folder.glob("*.whl"))


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
    """The programs of an environment with everything that the wheel asks for."""
    return environment(sys.executable, wheel, tmp_path_factory.mktemp("whole"))


@pytest.fixture(scope="module")
def without_pybullet(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The programs of an environment without PyBullet: a Python without wheels for it, if there is one."""
    programs = environment(newer_python() or sys.executable, wheel, tmp_path_factory.mktemp("without"))
    subprocess.run([programs / "pip", "uninstall", "--quiet", "--yes", "pybullet"], check=True)
    return programs


@pytest.fixture(scope="module")
def finished(whole: Path, home: Path) -> Path:
    """A run with its frames."""
    assert call(whole, home, "run", "crossing_pair", "--frames", "--out", "run").returncode == 0
    return home / "run"


def pip(python: str | Path, *arguments: str) -> None:
    command = [str(python), "-m", "pip", "--quiet", "--disable-pip-version-check", *arguments]
    subprocess.run(command, check=True, timeout=900)


def newer_python() -> str | None:
    """A Python for which PyBullet has no wheels: on the path, or one of pyenv's."""
    on_path = [path for name in WITHOUT_WHEELS if (path := shutil.which(name))]
    of_pyenv = [str(path) for path in sorted(Path.home().glob(".pyenv/versions/3.1[23].*/bin/python"))]
    for path in [*on_path, *of_pyenv]:
        if subprocess.run([path, "-c", ""], capture_output=True, check=False).returncode == 0:
            return path
    return None


def environment(python: str, wheel: Path, folder: Path) -> Path:
    subprocess.run([python, "-m", "venv", str(folder)], check=True)
    pip(folder / "bin" / "python", "install", "--constraint", str(CONSTRAINTS), str(wheel))
    return folder / "bin"


def call(programs: Path, cwd: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return run([str(programs / "peopleboy"), *arguments], cwd)


def run(command: list[str], cwd: Path) -> subprocess.CompletedProcess[str]:
    clean = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "VIRTUAL_ENV")}
    return subprocess.run(
        command, cwd=cwd, env=clean, capture_output=True, text=True, check=False, timeout=600
    )


def test_the_wheel_works_beside_a_users_own_modules_of_the_same_names(whole: Path, home: Path) -> None:
    done = call(whole, home, "run", "crossing_pair", "--tracker", "learned", "--no-rrd", "--out", "learned")
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
        ["run", "crossing_2", "--physics", "kinematic", "--no-rrd", "--out", "kinematic"],
        ["sweep", "crossing_2", "--seeds", "2", "--physics", "kinematic", "--out", "swept"],
    ],
    ids=" ".join,
)
def test_what_needs_no_pybullet_works_without_it(
    without_pybullet: Path, finished: Path, home: Path, arguments: list[str]
) -> None:
    assert finished.is_dir()
    done = call(without_pybullet, home, *arguments)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "crossing_2"],
        ["run", "dataset1"],
        ["sweep", "crossing_2", "--seeds", "2"],
        ["render", "crossing_2", "--seeds", "2"],
        ["compare", "--scenario", "single_follow", "--seeds", "1"],
        ["export", "run", "--format", "coco", "--out", "coco"],
    ],
    ids=" ".join,
)
def test_what_needs_pybullet_says_so_in_a_line_and_leaves_nothing(
    without_pybullet: Path, finished: Path, home: Path, arguments: list[str]
) -> None:
    assert finished.is_dir()
    before = sorted(home.rglob("*"))
    done = call(without_pybullet, home, *arguments)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert "pybullet" in done.stderr
    assert "3.11" in done.stderr
    assert sorted(home.rglob("*")) == before
