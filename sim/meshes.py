"""Triangle meshes from files."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from bad_input import BadInput


@cache
def load_triangles(path: Path) -> NDArray[np.float64]:
    """Read an OBJ, STL or DAE file: (T, 3, 3) corners of its triangles, in the file's frame, read-only.

    Raises:
        BadInput: there is no such file, it cannot be read, or it holds no triangle.
    """
    try:
        mesh: Any = trimesh.load(path, force="mesh", process=False, skip_materials=True)
        triangles = np.array(mesh.triangles, np.float64)
    except (OSError, ValueError, KeyError, IndexError, AttributeError) as error:
        raise BadInput(f"mesh {path}: it cannot be read ({error}); give an OBJ, STL or DAE file") from error
    if len(triangles) == 0 or not np.isfinite(triangles).all():
        raise BadInput(f"mesh {path}: it holds no triangles, or not finite ones")
    triangles.setflags(write=False)
    return triangles
