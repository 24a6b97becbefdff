"""Packages that only some formats need."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from peopleboy.bad_input import BadInput


def need(package: str, form: str) -> Any:
    """Import a package of the extra `export`.

    Raises:
        BadInput: it is not installed.
    """
    try:
        return import_module(package)
    except ImportError as error:
        name = package.split(".")[0]
        raise BadInput(f"--format {form} needs the package {name}: pip install {name}") from error
