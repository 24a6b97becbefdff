"""Files of a scenario's own that it names: a run keeps copies, so that its folder can be played by itself."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.scenario_file import ScenarioSpec
from peopleboy.sim.physics.urdf import MESH_PLACES, is_in_data

# How an OBJ names its materials, and these their textures; the name is a line's last word.
_NAMED = {".obj": r"^mtllib\s+(?:.*\s)?(\S+)\s*$", ".mtl": r"^(?:map_\w+|bump)\s+(?:.*\s)?(\S+)\s*$"}


def read_own_files(spec: ScenarioSpec, folder: Path) -> dict[str, bytes]:
    """Read the URDF files that lie beside a scenario, with their meshes, materials and textures.

    Args:
        spec: what the scenario says; its URDF files are known to be usable.
        folder: where its file lies.

    Returns:
        Contents by path within the folder.

    Raises:
        BadInput: a URDF takes a mesh from outside the folder.
    """
    found: dict[str, bytes] = {}
    for index, thing in enumerate(spec.things):
        if thing.urdf is None or is_in_data(thing.urdf):
            continue
        for path in _parts(folder / thing.urdf):
            if not path.resolve().is_relative_to(folder.resolve()):
                raise BadInput(
                    f"{path.resolve()} lies outside the scenario's own folder", key=("things", index, "urdf")
                )
            found[Path(os.path.relpath(path, folder)).as_posix()] = path.read_bytes()
    return found


def keep_own_files(files: Mapping[str, bytes], folder: Path) -> None:
    """Write copies where a scenario file in this folder looks for them."""
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def are_kept(files: Mapping[str, bytes], folder: Path) -> bool:
    """Return whether a folder has copies of these very files."""
    return all(
        (folder / name).is_file() and (folder / name).read_bytes() == content
        for name, content in files.items()
    )


def _parts(urdf: Path) -> Iterator[Path]:
    yield urdf
    text = re.sub(r"<\?xml.*?\?>", "", urdf.read_text("utf-8"), count=1)
    for part in ElementTree.fromstring(text).iter():
        name = part.get("filename", "").removeprefix("package://")
        places = [urdf.parent / place / name for place in MESH_PLACES] if name else []
        for path in [path for path in places if path.is_file()][:1]:
            yield path
            yield from _named_by(path)


def _named_by(path: Path) -> Iterator[Path]:
    """Yield what a mesh or a material names in turn."""
    pattern = _NAMED.get(path.suffix.lower())
    if pattern is None:
        return
    for name in re.findall(pattern, path.read_text("utf-8", errors="replace"), re.MULTILINE):
        other = path.parent / name
        if other.is_file():
            yield other
            yield from _named_by(other)
