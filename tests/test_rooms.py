import ast
from collections import Counter
from functools import cache
from pathlib import Path

import pytest

from tests.helpers.import_graph import (
    ROOMS,
    ROOT,
    children,
    circles,
    graph,
    imported,
    module_name,
    reach,
    room_files,
    statements,
    tree,
)

FILES = room_files()
ALLOWED: dict[str, set[str]] = {
    "geometry": set(),
    "sim": {"geometry"},
    "tracker": {"geometry"},
    "behaviours": {"geometry"},
    "scenarios": {"geometry", "sim", "tracker", "behaviours"},
    "studies": {"geometry", "sim", "tracker", "behaviours", "scenarios"},
}
COMMANDS = "scenarios.commands"  # the one place that imports `studies`, when a command runs
SHARED = {
    "peopleboy.bad_input",
    "peopleboy.notebook",
    "peopleboy.own_code",
    "peopleboy.random_streams",
    "peopleboy.registry",
    "peopleboy.settings",
    "peopleboy.user_files",
    "peopleboy.wording",
}
FOLDERS = sorted({str(path.parent.relative_to(ROOT)) for path in FILES.values()})
ELSEWHERE = ("tests", "benchmarks", "docs", "examples", "src")
MOST_MODULES = 15

# What runs where PyBullet is not installed; what needs it there says so when it is called.
WITHOUT_PHYSICS = (
    "geometry",
    "tracker",
    "behaviours",
    "sim.geometry",
    "sim.shapes",
    "sim.cameras",
    "sim.places",
    "sim.people.body",
    "sim.people.person",
    "sim.world_config",
    "sim.world",
    "sim.physics.kinematic",
    "sim.observation",
    "sim.truth.truth",
    "sim.truth.events",
    "scenarios.cli",
    "scenarios.commands",
    "scenarios.drawing",
    "scenarios.environments",
    "scenarios.export",
    "scenarios.files",
    "scenarios.footage",
    "scenarios.sim_to_real",
    "scenarios.loop",
    "scenarios.random_worlds",
    "scenarios.recording",
    "scenarios.report",
    "scenarios.run_folder",
    "scenarios.running",
    "scenarios.scores",
)
NEEDS_PHYSICS = "scenarios.export.dataset"


@cache
def arrows(*, only_at_load: bool = False) -> dict[str, set[str]]:
    """Who imports whom; the files are read when a test first asks."""
    return graph(FILES, only_at_load=only_at_load)


def lies_in(module: str, folder: str) -> bool:
    return module == folder or module.startswith(f"{folder}.")


def library_of(name: str) -> str:
    return name.split(".")[0]


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_imports_only_the_rooms_it_may(room: str) -> None:
    others = set(ROOMS) - {room} - ALLOWED[room]
    intruders = {
        module: found
        for module, names in arrows().items()
        if library_of(module) == room and (found := {name for name in names if library_of(name) in others})
    }
    assert not {module for module in intruders if not lies_in(module, COMMANDS)}
    assert not {name for found in intruders.values() for name in found if library_of(name) != "studies"}


def test_the_command_line_imports_studies_only_when_a_command_runs() -> None:
    importers = {
        module for module, names in arrows(only_at_load=True).items() if "studies" in map(library_of, names)
    }
    assert {library_of(module) for module in importers} == {"studies"}


@pytest.mark.parametrize("room", ROOMS)
def test_no_room_takes_the_public_names_which_would_lead_round_the_rule_above(room: str) -> None:
    names = {name for module in arrows() if library_of(module) == room for name in arrows()[module]}
    public = {name for name in names if library_of(name) == "peopleboy"}
    assert {name for name in public if name.rpartition(".")[0] not in SHARED} <= {
        f"peopleboy.{other}" for other in ROOMS
    }


def test_nobody_imports_a_room_but_through_the_package() -> None:
    paths = [path for top in (*ROOMS, *ELSEWHERE) for path in sorted((ROOT / top).rglob("*.py"))]
    bare = {
        str(path.relative_to(ROOT)): found
        for path in paths
        if (found := {name for name in imported(path) if library_of(name) in ROOMS})
    }
    assert not bare


@pytest.mark.parametrize(
    ("library", "home"), [("pybullet", "sim.physics.bullet"), ("rerun", "scenarios.recording")]
)
def test_a_library_is_imported_in_one_place_only(library: str, home: str) -> None:
    users = {module for module, names in arrows().items() if library in map(library_of, names)}
    assert users
    assert not {user for user in users if not lies_in(user, home)}


def test_nothing_that_needs_no_physics_loads_it_not_even_through_others() -> None:
    start = [
        module
        for module in FILES
        if any(lies_in(module, folder) for folder in WITHOUT_PHYSICS) and not lies_in(module, NEEDS_PHYSICS)
    ]
    assert {
        folder for folder in WITHOUT_PHYSICS if not any(lies_in(module, folder) for module in start)
    } == set()
    found = reach(start, arrows(only_at_load=True))
    assert {name: found[name] for name in found if library_of(name) in ("pybullet", "pybullet_data")} == {}


def test_the_tracker_loads_no_viewer_and_no_environment() -> None:
    start = [module for module in FILES if library_of(module) in ("tracker", "behaviours")]
    assert not {library_of(name) for name in reach(start, arrows())} & {"rerun", "gymnasium", "matplotlib"}


def test_no_module_has_a_name_that_says_nothing() -> None:
    empty = {"utils", "common", "core", "helpers", "misc"}
    assert not [module for module in FILES if set(module.split(".")) & empty]


def test_no_module_imports_itself_by_way_of_others() -> None:
    assert list(circles(arrows())) == []


@pytest.mark.parametrize("folder", FOLDERS)
def test_what_lies_side_by_side_is_imported_in_one_direction(folder: str) -> None:
    assert list(circles(children(folder.replace("/", "."), arrows()))) == []


def test_no_folder_has_more_modules_than_a_newcomer_can_take_in() -> None:
    paths = [
        path for top in (*ROOMS, *ELSEWHERE) for path in (ROOT / top).rglob("*.py") if path.stem != "__init__"
    ]
    sizes = Counter(str(path.parent.relative_to(ROOT)) for path in paths)
    assert {folder: size for folder, size in sizes.items() if size > MOST_MODULES} == {}


@pytest.mark.parametrize("room", ROOMS)
def test_no_class_name_stands_twice_in_a_room(room: str) -> None:
    homes: dict[str, list[str]] = {}
    for module, path in FILES.items():
        if library_of(module) == room:
            for node in statements(tree(path)):
                if isinstance(node, ast.ClassDef):
                    homes.setdefault(node.name, []).append(module)
    assert {name: found for name, found in homes.items() if len(found) > 1} == {}


@pytest.mark.parametrize("folder", FOLDERS)
def test_every_folder_says_in_a_line_what_it_is_about(folder: str) -> None:
    said = ast.get_docstring(tree(ROOT / folder / "__init__.py")) or ""
    assert said.split("\n")[0].endswith((".", ":"))


def test_a_circle_is_found_with_its_way() -> None:
    assert list(circles({"a": {"b"}, "b": {"c"}, "c": {"b"}})) == [("b", "c", "b"), ("c", "b", "c")]


def test_imports_inside_functions_and_for_type_checkers_load_nothing(tmp_path: Path) -> None:
    path = tmp_path / "some.py"
    lines = (
        "import a\nfrom b import c\nif TYPE_CHECKING:\n    import d\n"
        "try:\n    import e\nexcept ImportError:\n    pass\n"
        "def f():\n    import g\nclass H:\n    import i\n    def j(self):\n        import k\n"
    )
    path.write_text(lines, encoding="utf-8")
    assert imported(path, only_at_load=True) == {"a", "b.c", "e", "i"}
    assert imported(path) == {"a", "b.c", "d", "e", "g", "i", "k"}


def test_names_of_modules_are_those_of_their_files() -> None:
    assert module_name(ROOT / "sim" / "world.py") == "sim.world"
    assert module_name(ROOT / "sim" / "__init__.py") == "sim"
