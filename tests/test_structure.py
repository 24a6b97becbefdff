"""Rules for the size of folders and modules, and for the words that names are made of."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.helpers.import_graph import ROOMS, ROOT, graph, room_files, statements, tree

FILES = room_files()
FOLDERS = sorted({path.parent for path in FILES.values()})
FEWEST_MODULES, MOST_MODULES = 4, 15
DEEPEST = 3  # levels below a room
SMALL_LINES = 60
MOST_SMALL = 15
MOST_TWICE = 10

# A small module with a single importer is a part of that importer, unless there is a reason here.
SMALL_MODULES: dict[str, str] = {
    "behaviours.scripted": "a behaviour that the registry loads by its name",
    "scenarios.compiling": "imports numba, which a progress bar needs on a terminal only",
    "scenarios.footage.detect_polarity": "imports the detector, which other footage does not need first",
    "scenarios.footage.track_lines": "one of two ways to show tracks on the way",
    "scenarios.recording.live_tracks": "the other one, which imports rerun",
}

# A folder with fewer modules needs one as well.
SMALL_FOLDERS: dict[str, str] = {
    "geometry": "what all rooms share, and nothing else",
}

# Words that the field does not use, and what it says instead. No name of a module, class, function, argument
# or attribute contains them.
WORDS = {
    "told": "reported, confirmed, given",
    "tells": "reports, returns",
    "somebody": "person",
    "whom": "person",
    "looks": "appearance, clothing",
    "lesson": "training",
    "lessons": "training",
    "proposal": "detection",
    "proposals": "detections",
}


def modules_in(folder: Path) -> list[Path]:
    return [path for path in folder.glob("*.py") if path.stem not in ("__init__", "__main__")]


def has_folders(folder: Path) -> bool:
    return any((child / "__init__.py").exists() for child in folder.iterdir() if child.is_dir())


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: str(folder.relative_to(ROOT)))
def test_a_folder_has_four_to_fifteen_modules(folder: Path) -> None:
    count, name = len(modules_in(folder)), str(folder.relative_to(ROOT))
    assert count <= MOST_MODULES
    assert count >= FEWEST_MODULES or has_folders(folder) or name in SMALL_FOLDERS


def test_no_folder_lies_deeper_than_three_levels_below_its_room() -> None:
    deep = [folder for folder in FOLDERS if len(folder.relative_to(ROOT).parts) > 1 + DEEPEST]
    assert not deep


def test_a_small_module_with_one_importer_has_a_reason() -> None:
    importers = defaultdict(set)
    for module, others in graph(FILES).items():
        for other in others:
            importers[other].add(module)
    small = {
        module
        for module, path in FILES.items()
        if path.stem not in ("__init__", "__main__")
        and len(importers[module]) == 1
        and len(path.read_text(encoding="utf-8").splitlines()) < SMALL_LINES
    }
    assert small == set(SMALL_MODULES)
    assert len(small) <= MOST_SMALL


def homes(names: Iterator[tuple[str, str]]) -> dict[str, list[str]]:
    found = defaultdict(list)
    for name, module in names:
        found[name].append(module)
    return {name: modules for name, modules in found.items() if len(modules) > 1}


def classes() -> Iterator[tuple[str, str]]:
    for module, path in FILES.items():
        yield from ((node.name, module) for node in statements(tree(path)) if isinstance(node, ast.ClassDef))


def module_names() -> Iterator[tuple[str, str]]:
    yield from (
        (path.stem, module) for module, path in FILES.items() if path.stem not in ("__init__", "__main__")
    )


@pytest.mark.parametrize("kind", [classes, module_names])
def test_few_names_stand_twice_and_none_in_one_room(kind) -> None:
    twice = homes(kind())
    rooms = {name: [module.split(".")[0] for module in modules] for name, modules in twice.items()}
    assert {name: twice[name] for name, found in rooms.items() if len(found) > len(set(found))} == {}
    assert len(twice) <= MOST_TWICE, sorted(twice)


def names_in(path: Path) -> Iterator[str]:
    yield path.stem
    for node in ast.walk(tree(path)):
        match node:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name) | ast.arg(arg=name):
                yield name
            case ast.Name(id=name) | ast.Attribute(attr=name) | ast.keyword(arg=str(name)):
                yield name


def words_of(name: str) -> list[str]:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower().split("_")


@pytest.mark.parametrize("room", ROOMS)
def test_names_are_made_of_words_of_the_field(room: str) -> None:
    found = {
        (module, name)
        for module, path in FILES.items()
        if module.split(".")[0] == room
        for name in names_in(path)
        if set(words_of(name)) & set(WORDS)
    }
    assert not found


def test_words_are_found_in_names_of_either_case() -> None:
    assert words_of("TrackLooks") == ["track", "looks"]
    assert words_of("is_told_s") == ["is", "told", "s"]
