"""What a process runs: versions of the packages on which bytes depend, and PeopleBoy's own source."""

from __future__ import annotations

import os
from functools import cache
from hashlib import sha256
from pathlib import Path

from peopleboy import sim
from peopleboy.scenarios.run_folder.folder import versions

Source = dict[str, str]


@cache
def running_source() -> Source:
    """Tell packages by name with their versions, and under "source" a hash of PeopleBoy's own files."""
    digest = sha256()
    root = Path(sim.__path__[0]).parent
    for folder, inner, names in os.walk(root, followlinks=True):
        inner.sort()
        for name in sorted(names):
            if name.endswith((".py", ".yaml", ".urdf")):
                path = Path(folder, name)
                digest.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes())
    return versions() | {"source": digest.hexdigest()}
