"""Files of a scenario's own that it names: a run keeps copies, so that its folder can be played by itself."""

import os
from collections.abc import Mapping
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.scenario_file import ScenarioSpec
from peopleboy.sim.physics.urdf import files_of, is_in_data


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
        for path in files_of(folder / thing.urdf):
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
