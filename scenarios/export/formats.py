"""The table of export formats: one entry a format, loaded when it is asked for.

Other packages add formats by entry points of the group `peopleboy.exports`: each names a function as those of
this table, `write(runs, folder, play)`, and is offered under the entry point's name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module
from inspect import signature
from typing import Any, Final

from peopleboy.bad_input import BadInput

FORMATS: Final[Mapping[str, str]] = {
    "mot": "peopleboy.scenarios.export.mot:write_mot",
    "coco": "peopleboy.scenarios.export.coco:write_coco",
    "images": "peopleboy.scenarios.export.camera_images:write_label_images",
    "yolo": "peopleboy.scenarios.export.yolo:write_yolo",
    "yolo-pose": "peopleboy.scenarios.export.yolo:write_yolo_pose",
    "viper": "peopleboy.scenarios.export.viper:write_viper",
    "mcap": "peopleboy.scenarios.export.ros_bag:write_mcap",
    "mp4": "peopleboy.scenarios.export.video:write_mp4",
}
GROUP: Final = "peopleboy.exports"

Writer = Callable[..., None]


@cache
def format_names() -> tuple[str, ...]:
    """Name all formats, those of other packages last."""
    return tuple(dict.fromkeys((*FORMATS, *_entry_points())))


def load_writer(name: str) -> Writer:
    """Load the function that writes a format; its further parameters are the options that it takes."""
    if name not in FORMATS:
        writer: Writer = _entry_points()[name].load()
        return writer
    module, _, function = FORMATS[name].partition(":")
    own: Writer = getattr(import_module(module), function)
    return own


def takes(name: str, option: str) -> bool:
    """Tell whether a format has an option: `camera`, `least_px` or `boxes`."""
    return option in signature(load_writer(name)).parameters


def _entry_points() -> Mapping[str, Any]:
    from importlib.metadata import entry_points  # here, as it takes a tenth of a second

    return {entry.name: entry for entry in entry_points(group=GROUP)}


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
