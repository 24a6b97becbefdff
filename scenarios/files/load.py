"""Find scenarios by library name or path, and read them."""

import logging
import reprlib
from pathlib import Path
from typing import Any

from peopleboy.bad_input import BadInput, found_in
from peopleboy.scenarios.files.library import LIBRARY, SUITES
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.files.scenario import Scenario, make_scenario
from peopleboy.scenarios.files.scenario_file import ScenarioSpec
from peopleboy.scenarios.files.validation import validated
from peopleboy.wording import hint

_LOG = logging.getLogger(__name__)


def load_scenario(name_or_path: str | Path | Scenario) -> Scenario:
    """Load a scenario by its library name or by the path of a YAML file; return a loaded one unchanged.

    Raises:
        BadInput: the scenario does not exist, or the file is invalid.
    """
    if isinstance(name_or_path, Scenario):
        return name_or_path
    path = _find(name_or_path)
    _LOG.info("scenario %s from %s", path.stem, path)
    return parse_scenario(read_yaml(path), source=_shown(path), folder=path.parent)


def load_unchecked(name_or_path: str | Path) -> Scenario | None:
    """Load a scenario without checking paths, people and robot, to draw what is wrong; None if that fails."""
    try:
        path = _find(name_or_path)
        spec = validated(ScenarioSpec, _filled_in(read_yaml(path)))
        return make_scenario(spec, path.parent, is_checked=False)
    except BadInput:
        return None


def parse_scenario(data: dict[Any, Any], *, source: str, folder: Path) -> Scenario:
    """Check the data of a scenario file.

    Args:
        data: contents of the file.
        source: name of the file, for messages.
        folder: folder that contains the scenario's own URDF files.

    Raises:
        BadInput: the data are invalid.
    """
    with found_in(file=source):
        return make_scenario(validated(ScenarioSpec, _filled_in(data)), folder)


def _filled_in(data: dict[Any, Any], via: tuple[str, ...] = ()) -> dict[Any, Any]:
    """Return the data, with omitted keys taken from the library scenario named by `like`.

    Raises:
        BadInput: the library has no such scenario, or `like` leads back to the scenario itself.
    """
    if not isinstance(data.get("like"), str):
        return data
    with found_in("like"):
        path = _find_in_library(data["like"], "`like` takes a library name, not a file")
        if path.stem in via:
            raise BadInput(f"{path.stem!r} is like itself, via {', '.join(via)}; remove one of these keys")
    model = _filled_in(read_yaml(path), (*via, path.stem))
    return {key: value for key, value in (model | data).items() if key != "like"}


def _find(name_or_path: str | Path) -> Path:
    text = str(name_or_path)
    if "/" in text or text.endswith((".yaml", ".yml")) or isinstance(name_or_path, Path):
        return Path(name_or_path)
    return _find_in_library(text, "the path of a file must end in .yaml")


def _find_in_library(name: str, otherwise: str) -> Path:
    known = [path.stem for path in LIBRARY.glob("*.yaml")]
    if name in {path.stem for path in SUITES.glob("*.yaml")}:
        raise BadInput(f"{name} is a suite of scenarios; only `peopleboy run` accepts suites")
    if name not in known:
        which = hint(name, known, "`peopleboy list` shows all")
        raise BadInput(f"unknown scenario {reprlib.repr(name)}; {which}; {otherwise}")
    return LIBRARY / f"{name}.yaml"


def _shown(path: Path) -> str:
    """Return the path as the user gave it; for a library file, library/NAME.yaml."""
    return f"library/{path.name}" if path.parent == LIBRARY else str(path)
