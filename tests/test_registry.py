"""Trackers, behaviours and export formats of other packages, by their entry points."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from peopleboy.behaviours.make_behaviour import BEHAVIOURS, make_behaviour
from peopleboy.registry import Entry, Registry, plug_ins
from peopleboy.scenarios.export.formats import FORMATS
from peopleboy.tracker.trackers import TRACKERS, is_own, make_tracker
from tests.helpers.calls.command_line import refusal
from tests.helpers.calls.refused import assert_names, refused

SOURCE = """
class Blind:
    cameras = ("thermal",)
    def __init__(self, rng): pass
    def update(self, frame): return ()

class Halt:
    mode, reason, following = "halt", "", None
    def command(self, percept):
        from peopleboy.behaviours.behaviour import Command
        return Command(0.0, 0.0)

def write(runs, folder, play): pass

NUMBER = 3
"""

Install = Callable[..., None]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Install a package, as pip lays it out, that registers entry points given as group, name, target."""

    def installed(package: str, *entries: tuple[str, str, str], source: str = SOURCE) -> None:
        site = tmp_path / f"site-{package}"
        info = site / f"{package}-1.0.dist-info"
        info.mkdir(parents=True)
        (site / f"{package}.py").write_text(source)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
        lines = [f"[peopleboy.{group}]\n{name} = {target}\n" for group, name, target in entries]
        (info / "entry_points.txt").write_text("\n".join(lines))
        monkeypatch.syspath_prepend(str(site))
        plug_ins.cache_clear()

    yield installed
    plug_ins.cache_clear()


def test_a_package_adds_a_tracker_a_behaviour_and_a_format(install: Install) -> None:
    install("added_kit", ("trackers", "blind", "added_kit:Blind"))
    install("added_rest", ("behaviours", "halt", "added_rest:Halt"), ("exports", "none", "added_rest:write"))
    assert list(TRACKERS)[-1] == "blind"
    assert is_own("blind")
    assert make_tracker("blind").cameras == ("thermal",)
    assert make_behaviour("halt").mode == "halt"
    assert "halt" in BEHAVIOURS
    assert list(FORMATS)[-1] == "none"
    assert callable(FORMATS["none"])


def test_a_broken_package_is_one_line(install: Install, capsys: pytest.CaptureFixture[str]) -> None:
    install("broken_kit", ("trackers", "broken", "broken_kit:Gone"))
    assert_names(
        refusal(capsys, "run", "empty_room", "--tracker", "broken"),
        "tracker 'broken'",
        "broken_kit:Gone",
        "package broken_kit",
        "cannot be loaded",
    )
    install("faulty_kit", ("behaviours", "faulty", "faulty_kit:Halt"), source="raise OSError('no licence')\n")
    with refused("behaviour 'faulty'", "package faulty_kit", "no licence"):
        make_behaviour("faulty")
    install("number_kit", ("trackers", "number", "number_kit:NUMBER"))
    with refused("tracker 'number'", "must be a class or a function, got 3"):
        make_tracker("number")
    install("halting_kit", ("trackers", "halting", "halting_kit:Halt"))
    with refused("tracker 'halting'", "cannot be made; it is called with a numpy.random.Generator"):
        make_tracker("halting")


def test_a_name_that_is_taken_is_refused(install: Install) -> None:
    install("clashing_kit", ("trackers", "thesis", "clashing_kit:Blind"))
    with refused("tracker 'thesis'", "package clashing_kit", "PeopleBoy ships"):
        make_tracker("thesis")
    install("first_kit", ("trackers", "blind", "first_kit:Blind"))
    install("second_kit", ("trackers", "blind", "second_kit:Blind"))
    with refused("tracker 'blind'", "package first_kit", "package second_kit"):
        make_tracker("blind")


def test_an_entry_is_loaded_when_it_is_asked_for() -> None:
    table = Registry("shape", "peopleboy.none", {"gone": Entry("no_such_module:Shape")})
    assert list(table) == ["gone"]
    with pytest.raises(ModuleNotFoundError):
        table["gone"]

    @table.register("square", summary="four equal sides", scope="plane")
    def square() -> int:
        return 4

    assert table["square"]() == square() == 4
    assert (table.shipped["square"].summary, table.shipped["square"].scope) == ("four equal sides", "plane")
    with pytest.raises(KeyError):
        table["circle"]


def test_naming_the_trackers_loads_none_of_them() -> None:
    import subprocess
    import sys

    code = "import sys; from peopleboy.tracker.trackers import TRACKERS; list(TRACKERS); "
    code += "print([name for name in sys.modules if name.startswith('peopleboy.tracker.')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "['peopleboy.tracker.tracker_names', 'peopleboy.tracker.trackers']"
