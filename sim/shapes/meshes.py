"""Triangle meshes from files."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput


@cache
def load_triangles(path: Path) -> NDArray[np.float64]:
    """Read an OBJ, STL or DAE file: (T, 3, 3) corners of its triangles, in the file's frame, read-only.

    Like PyBullet, it heeds the unit of length of a DAE file and not which axis it calls up. Unlike PyBullet,
    it heeds the rotations in a DAE file, so that TinyRenderer draws the few files with any in another way.

    Raises:
        BadInput: there is no such file, it cannot be read, or it holds no triangle.
    """
    import trimesh  # here, as it takes a second to load, and most worlds have no meshes

    try:
        mesh: Any = trimesh.load(path, force="mesh", process=False, skip_materials=True)
        triangles = np.array(mesh.triangles, np.float64) * _unit_m(path)
    # Each of the parsers behind trimesh fails in ways of its own.
    except Exception as error:
        reason = " ".join(str(error).split())
        raise BadInput(f"mesh {path}: it cannot be read ({reason}); give an OBJ, STL or DAE file") from error
    if len(triangles) == 0 or not np.isfinite(triangles).all():
        raise BadInput(f"mesh {path}: it holds no triangles, or not finite ones")
    triangles.setflags(write=False)
    return triangles


def _unit_m(path: Path) -> float:
    """Unit of length [m] of a mesh file; only DAE files name one."""
    unit = ElementTree.parse(path).find("{*}asset/{*}unit") if path.suffix.lower() == ".dae" else None
    return 1.0 if unit is None else float(unit.get("meter", "1"))
