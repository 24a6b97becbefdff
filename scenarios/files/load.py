"""Find scenarios, by name in the library or by path, and read them."""

import logging
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
    """Load a scenario by its library name, or by the path of a YAML file; one that is loaded is returned.

    Raises:
        BadInput: there is no such scenario, or the file is wrong: file, key, value and what would be right.
    """
    if isinstance(name_or_path, Scenario):
        return name_or_path
    path = _find(name_or_path)
    _LOG.info("scenario %s from %s", path.stem, path)
    return parse_scenario(read_yaml(path), source=_shown(path), folder=path.parent)


def parse_scenario(data: dict[Any, Any], *, source: str, folder: Path) -> Scenario:
    """Check the data of a scenario file.

    Args:
        data: what the file holds.
        source: the file's name, for messages.
        folder: where URDF files of the scenario's own lie.

    Raises:
        BadInput: the data are wrong.
    """
    with found_in(file=source):
        return make_scenario(validated(ScenarioSpec, _filled_in(data)), folder)


def _filled_in(data: dict[Any, Any], via: tuple[str, ...] = ()) -> dict[Any, Any]:
    """The data with the keys of the scenario that it is like; its own replace them whole.

    Raises:
        BadInput: there is no such scenario in the library, or it is in the end like itself.
    """
    if not isinstance(data.get("like"), str):
        return data
    with found_in("like"):
        path = _find_in_library(data["like"], "only those can be named here, no file")
        if path.stem in via:
            raise BadInput(f"{path.stem!r} is like itself, by way of {', '.join(via)}; leave it out of one")
    model = _filled_in(read_yaml(path), (*via, path.stem))
    return {key: value for key, value in (model | data).items() if key != "like"}


def _find(name_or_path: str | Path) -> Path:
    text = str(name_or_path)
    if "/" in text or text.endswith((".yaml", ".yml")) or isinstance(name_or_path, Path):
        return Path(name_or_path)
    return _find_in_library(text, "a file's path ends in .yaml")


def _find_in_library(name: str, otherwise: str) -> Path:
    known = [path.stem for path in LIBRARY.glob("*.yaml")]
    if (SUITES / f"{name}.yaml").is_file():
        raise BadInput(f"{name} is a suite of scenarios, which only `peopleboy run` takes whole")
    if name not in known:
        which = hint(name, known, "`peopleboy list` names those that there are")
        raise BadInput(f"unknown scenario {name!r}; {which}; {otherwise}")
    return LIBRARY / f"{name}.yaml"


def _shown(path: Path) -> str:
    """The path as the user gave it; a library file as library/NAME.yaml."""
    return f"library/{path.name}" if path.parent == LIBRARY else str(path)
