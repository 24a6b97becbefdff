"""Whether runs compared as those of one scenario and seed are so: a file may be edited in between."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.run_folder.finished_run import read_run

Scene = tuple[str, int]
"""Scenario, or footage, and seed."""

_BESIDE: Final = ("drawn", "description", "physics")  # which make no other scene, or are an option of `run`
_OF_ROBOT: Final = ("tracker", "behaviour", "cameras")  # the same; of cameras, those mounted for a tracker


def check_same_scenes(sides: Sequence[Mapping[Path, Scene | None]]) -> None:
    """Refuse runs of several sides that say to be of the same scene, but are not.

    Args:
        sides: what is compared with each other: the folders of runs, and what their run.json says to be seen.

    Raises:
        BadInput: scenarios of the same name and seed differ in more than tracker and behaviour.
    """
    first: dict[Scene, tuple[int, Path]] = {}
    for side, runs in enumerate(sides):
        for folder, scene in runs.items():
            if scene is None:
                continue
            home, other = first.setdefault(scene, (side, folder))
            if home != side and (change := _change(other, folder)):
                raise BadInput(
                    f"{folder}: is another {scene[0]}, seed {scene[1]}, than {other}: {change}; run both "
                    "again, or give one of the scenarios another name"
                )


def _change(one: Path, other: Path) -> str:
    """Say in what the scenes of two runs differ first; nothing if they do not, or one is not known."""
    paths = one / "scenario.yaml", other / "scenario.yaml"
    if not all(path.is_file() for path in paths) or paths[0].read_bytes() == paths[1].read_bytes():
        return ""
    before, after = map(_scene, paths)
    return next(_changes(before, after, ""), "") if before and after else ""


def _scene(path: Path) -> Mapping[str, Any]:
    """Read what there is to be seen, the robot's own cameras included; nothing of a file that is spoilt."""
    try:
        data = read_yaml(path)
    except BadInput:  # of which whoever plays the scene again tells
        return {}
    if "place" not in data:
        return {}
    robot = said if isinstance(said := data.get("robot"), dict) else {}
    mounted = read_run(path.parent).get("mounted_for_tracker", ())
    cameras = {name: said for name, said in robot.get("cameras", {}).items() if name not in mounted}
    kept = {key: said for key, said in robot.items() if key not in _OF_ROBOT}
    return {key: said for key, said in data.items() if key not in _BESIDE} | {
        "robot": kept | {"cameras": cameras}
    }


def _changes(before: Any, after: Any, where: str) -> Iterator[str]:
    """Tell key by key what differs."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in dict.fromkeys((*before, *after)):
            yield from _changes(before.get(key), after.get(key), f"{where}.{key}" if where else str(key))
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for number, pair in enumerate(zip(before, after, strict=True)):
            yield from _changes(*pair, f"{where}[{number}]")
    elif before != after:
        yield f"{where} is {_shown(after)}, not {_shown(before)}"


def _shown(value: Any) -> str:
    return (
        f"a list of {len(value)}" if isinstance(value, list) else "left out" if value is None else repr(value)
    )
