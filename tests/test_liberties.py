"""Kernels whose sums may be reordered do not hand that on, whoever compiles them first.

numba lets a kernel inherit the `fastmath` of the one that calls it first, and caches that: what it comes to
would depend on what was run before. One that is called by such a kernel therefore says itself what it may.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOMS = ("geometry", "sim", "tracker", "behaviours", "scenarios", "studies")
Name = tuple[str, str]


def kernels() -> Iterator[tuple[Name, ast.FunctionDef, str | None, dict[str, Name]]]:
    """Give every kernel, by module and name, with its `fastmath` and what its module imports."""
    for path in (path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py"))):
        text = path.read_text(encoding="utf-8")
        if "njit" not in text:
            continue
        tree = ast.parse(text)
        module = ".".join(("peopleboy", *path.relative_to(ROOT).with_suffix("").parts))
        imported = {
            alias.asname or alias.name: (node.module, alias.name)
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and node.module
            for alias in node.names
        }
        for function in (node for node in tree.body if isinstance(node, ast.FunctionDef)):
            for decorator in function.decorator_list:
                call = decorator.func if isinstance(decorator, ast.Call) else decorator
                if isinstance(call, ast.Name) and call.id == "njit":
                    options = decorator.keywords if isinstance(decorator, ast.Call) else []
                    fastmath = [ast.unparse(one.value) for one in options if one.arg == "fastmath"]
                    yield (module, function.name), function, next(iter(fastmath), None), imported


def test_a_kernel_called_by_one_with_liberties_says_which_it_has_itself() -> None:
    found = {name: (function, fastmath, imported) for name, function, fastmath, imported in kernels()}
    assert len(found) > 200
    silent = set()
    for (module, _), (function, fastmath, imported) in found.items():
        if fastmath not in (None, "False"):
            called = {
                node.func.id
                for node in ast.walk(function)
                if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
            }
            for name in called:
                callee = (module, name) if (module, name) in found else imported.get(name)
                if callee in found and found[callee][1] is None:
                    silent.add(callee)
    assert not silent
