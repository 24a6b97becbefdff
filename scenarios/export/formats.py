"""The table of export formats: one entry a format, loaded when it is asked for.

Other packages add formats by entry points of the group `peopleboy.exports`: each names a function as those of
this table, `write(runs, folder, play)`, and is offered under the entry point's name.
"""

from collections.abc import Callable
from importlib import import_module
from inspect import signature
from typing import Any, Final

from peopleboy.bad_input import BadInput
from peopleboy.registry import Entry, Registry

_HERE: Final = "peopleboy.scenarios.export"

Writer = Callable[..., None]

FORMATS: Final = Registry(
    "export format",
    "peopleboy.exports",
    {
        "mot": Entry(f"{_HERE}.mot:write_mot", "MOTChallenge, for TrackEval"),
        "coco": Entry(f"{_HERE}.coco:write_coco", "masks, boxes, keypoints"),
        "images": Entry(
            f"{_HERE}.replay:write_label_images",
            "beside every image, who is at each pixel, which part of the body, and true depth",
        ),
        "yolo": Entry(f"{_HERE}.yolo:write_yolo", "boxes, for Ultralytics"),
        "yolo-pose": Entry(f"{_HERE}.yolo:write_yolo_pose", "boxes and keypoints, for Ultralytics"),
        "viper": Entry(f"{_HERE}.viper:write_viper", "ViPER XML"),
        "mcap": Entry(f"{_HERE}.ros.ros_bag:write_mcap", "ROS 2 bags"),
        "mp4": Entry(f"{_HERE}.video:write_mp4", "films"),
    },
)
"""The formats by name; each is called with `(runs, folder, play)`; further parameters are its options."""


def takes(name: str, option: str) -> bool:
    """Return whether a format has an option: `camera`, `least_px` or `boxes`."""
    return option in signature(FORMATS[name]).parameters


def need(package: str, option: str) -> Any:
    """Import a package of the extra `export`, which an option of the command line wants.

    Raises:
        BadInput: it is not installed.
    """
    try:
        return import_module(package)
    except ImportError as error:
        name = package.split(".")[0]
        raise BadInput(f"{option} needs the package {name}: pip install {name}") from error
