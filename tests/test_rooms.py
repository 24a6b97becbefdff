import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ROOMS = ("sim", "tracker", "behaviours", "scenarios")
ALLOWED = {"sim": set(), "tracker": set(), "behaviours": set(), "scenarios": {"sim", "tracker", "behaviours"}}
FILES = [path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py"))]


def imports(path: Path) -> set[str]:
    """Every module that a file imports, also inside functions."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            found.add(node.module or "")
    return found


def packages(path: Path) -> set[str]:
    return {name.split(".")[0] for name in imports(path)}


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_imports_only_the_rooms_it_may(room: str) -> None:
    others = set(ROOMS) - {room} - ALLOWED[room]
    intruders = {
        str(path.relative_to(ROOT)): packages(path) & others
        for path in FILES
        if path.relative_to(ROOT).parts[0] == room
    }
    assert not {path: found for path, found in intruders.items() if found}


@pytest.mark.parametrize(
    ("library", "home"), [("pybullet", "sim/physics/bullet.py"), ("rerun", "scenarios/recording")]
)
def test_a_library_is_imported_in_one_place_only(library: str, home: str) -> None:
    users = {str(path.relative_to(ROOT)) for path in FILES if library in packages(path)}
    assert users
    assert not {user for user in users if user != home and not user.startswith(f"{home}/")}


def test_no_module_has_a_name_that_says_nothing() -> None:
    empty = {"utils", "common", "core", "helpers", "misc"}
    assert not [path for path in FILES if path.stem in empty or path.parent.name in empty]


def test_no_module_imports_itself_by_way_of_others() -> None:
    names = {".".join(path.relative_to(ROOT).with_suffix("").parts): path for path in FILES}
    graph = {name: imports(path) & names.keys() for name, path in names.items()}
    done: set[str] = set()

    def visit(name: str, above: tuple[str, ...]) -> None:
        assert name not in above, " -> ".join((*above, name))
        if name not in done:
            for other in sorted(graph[name]):
                visit(other, (*above, name))
            done.add(name)

    for name in sorted(graph):
        visit(name, ())


def test_tracker_and_evaluation_need_no_physics_engine() -> None:
    reach = {name for path in FILES if path.parts[-2] in ("tracker", "evaluation") for name in packages(path)}
    assert not reach & {"pybullet", "pybullet_data", "rerun"}
