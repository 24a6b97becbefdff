"""Copy the files that a scenario refers to into the run's folder, so that the run can be replayed from it."""

import os
from collections.abc import Mapping
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.scenario_file import ScenarioSpec
from peopleboy.sim.physics.urdf import files_of, is_in_data


def read_own_files(spec: ScenarioSpec, folder: Path) -> dict[str, bytes]:
    """Read a scenario's own URDF files, with their meshes, materials and textures.

    Args:
        spec: the scenario, with validated URDF files.
        folder: folder of the scenario file.

    Returns:
        Contents by path relative to the folder.

    Raises:
        BadInput: a URDF refers to a mesh outside the folder.
    """
    found: dict[str, bytes] = {}
    for index, thing in enumerate(spec.things):
        if thing.urdf is None or is_in_data(thing.urdf):
            continue
        for path in files_of(folder / thing.urdf):
            if not path.resolve().is_relative_to(folder.resolve()):
                raise BadInput(
                    f"{path.resolve()} lies outside the scenario's folder", key=("things", index, "urdf")
                )
            found[Path(os.path.relpath(path, folder)).as_posix()] = path.read_bytes()
    return found


def keep_own_files(files: Mapping[str, bytes], folder: Path) -> None:
    """Write copies to the paths that a scenario file in this folder refers to."""
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def are_kept(files: Mapping[str, bytes], folder: Path) -> bool:
    """Return whether a folder has identical copies of these files."""
    return all(
        (folder / name).is_file() and (folder / name).read_bytes() == content
        for name, content in files.items()
    )
