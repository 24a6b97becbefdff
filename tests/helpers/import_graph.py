"""Who imports whom in the rooms, read from the files."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path

ROOT = Path(__file__).parents[2]
ROOMS = ("geometry", "sim", "tracker", "behaviours", "scenarios", "studies")
PACKAGE = "peopleboy"

Graph = Mapping[str, Collection[str]]

_BLOCKS = ("body", "orelse", "finalbody", "handlers", "cases")


def room_files() -> dict[str, Path]:
    """Every module of the rooms by its name within the package, such as sim.world."""
    paths = (path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py")))
    return {module_name(path): path for path in paths}


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def imported(path: Path, *, only_at_load: bool = False) -> set[str]:
    """Whole names of what a file imports: modules, or names in them.

    Args:
        path: a Python file.
        only_at_load: leave out what is imported inside functions, or for type checkers alone.
    """
    found: set[str] = set()
    for node in statements(tree(path), only_at_load=only_at_load):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def graph(files: Mapping[str, Path], *, only_at_load: bool = False) -> dict[str, set[str]]:
    """Arrows between the modules of the rooms; what else they import keeps its whole name."""
    return {
        name: {_module_of(told, files) for told in imported(path, only_at_load=only_at_load)}
        for name, path in files.items()
    }


def reach(start: Iterable[str], arrows: Graph) -> dict[str, str]:
    """Everything that is imported from some modules on, each with the one that imports it first."""
    found, ahead = {}, list(start)
    while ahead:
        module = ahead.pop()
        for other in arrows.get(module, ()):
            if other not in found:
                found[other] = module
                ahead.append(other)
    return found


def circles(arrows: Graph) -> Iterator[tuple[str, ...]]:
    """A way from each module that imports itself by way of others back to it."""
    for module in arrows:
        found = reach([module], arrows)
        if module in found:
            way = [module]
            while (way := [found[way[0]], *way])[0] != module:
                pass
            yield tuple(way)


def children(parent: str, arrows: Graph) -> dict[str, set[str]]:
    """Arrows between what lies side by side in a folder: modules, and sub-folders taken whole."""
    found: dict[str, set[str]] = {}
    for module, others in arrows.items():
        child = _child(parent, module)
        beside = {_child(parent, other) for other in others if other in arrows} - {None, child}
        if child is not None:
            found.setdefault(child, set()).update(beside)
    return found


def _child(parent: str, module: str) -> str | None:
    prefix = f"{parent}."
    return module.removeprefix(prefix).split(".")[0] if module.startswith(prefix) else None


def _module_of(name: str, files: Mapping[str, Path]) -> str:
    """The module in which an imported name lies."""
    inner = name.removeprefix(f"{PACKAGE}.")
    if inner in files:
        return inner
    outer = inner.rpartition(".")[0]
    return outer if outer in files else name


def statements(node: ast.AST, *, only_at_load: bool = False) -> Iterator[ast.AST]:
    """Everything in a file that is no expression, in which nobody imports and no class is."""
    for child in (child for block in _BLOCKS for child in getattr(node, block, ())):
        if only_at_load and isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        if only_at_load and isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            continue
        yield child
        yield from statements(child, only_at_load=only_at_load)
