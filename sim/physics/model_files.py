"""Where the models are that come with PyBullet, found without loading it."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from peopleboy.bad_input import BadInput

MISSING = "pybullet is not installed: its wheels are for Linux and Python 3.10 or 3.11; use Python 3.11"
"""What is said wherever PyBullet or its models are needed and are not there."""

MISSING_PHYSICS = f"{MISSING}, or physics kinematic, which needs none"
"""What is said where PyBullet is to move the robot and is not there."""


def data_folder() -> Path:
    """The folder of pybullet_data.

    Raises:
        BadInput: PyBullet is not installed.
    """
    folder = _data_folder()
    if folder is None:
        raise BadInput(MISSING)
    return folder


def is_in_data(path: Path | str) -> bool:
    """Return whether a file, by its name or its whole path, is one of pybullet_data."""
    folder = _data_folder()
    return folder is not None and (folder / path).is_file() and (folder / path).is_relative_to(folder)


def _data_folder() -> Path | None:
    spec = importlib.util.find_spec("pybullet_data")
    return None if spec is None or spec.origin is None else Path(spec.origin).parent


def find_model(path: Path | str) -> Path:
    """Find a URDF or SDF file: as it stands, else in pybullet_data.

    Raises:
        BadInput: there is no such file, or PyBullet is not installed.
    """
    if Path(path).is_file():
        return Path(path).resolve()
    candidate = data_folder() / path
    if candidate.is_file():
        return candidate.resolve()
    raise BadInput(f"model file {path}: there is no such file, neither as it stands nor in pybullet_data")
