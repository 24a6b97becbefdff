"""The table of export formats: one entry per format, imported on first use.

Other packages add formats by entry points of the group `peopleboy.exports`. Each names a function with the
signature of this table, `write(runs, folder, play)`; the format has the entry point's name.
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
            "images with person, body part and true depth of each pixel",
        ),
        "yolo": Entry(f"{_HERE}.yolo:write_yolo", "boxes, for Ultralytics"),
        "yolo-pose": Entry(f"{_HERE}.yolo:write_yolo_pose", "boxes and keypoints, for Ultralytics"),
        "webdataset": Entry(
            f"{_HERE}.hubs.image_datasets:write_webdataset", "tar files of images and labels, for WebDataset"
        ),
        "huggingface": Entry(
            f"{_HERE}.hubs.image_datasets:write_huggingface",
            "parquet files of images and labels, for `datasets`",
        ),
        "minari": Entry(f"{_HERE}.hubs.minari_episodes:write_minari", "episodes of environments, for Minari"),
        "lerobot": Entry(
            f"{_HERE}.hubs.lerobot_episodes:write_lerobot", "episodes of environments, for LeRobot"
        ),
        "viper": Entry(f"{_HERE}.viper:write_viper", "ViPER XML"),
        "mcap": Entry(f"{_HERE}.ros.ros_bag:write_mcap", "ROS 2 bags"),
        "mp4": Entry(f"{_HERE}.video:write_mp4", "films"),
    },
)
"""The formats by name; each is called with `(runs, folder, play)`, and further parameters are options."""

SEQUENCES: Final = ("minari", "lerobot", "mot", "viper", "mcap", "mp4")
"""Formats of whole sequences, of which no frame can be left out."""


def takes(name: str, option: str) -> bool:
    """Return whether a format has an option: `camera`, `least_px` or `boxes`."""
    return option in signature(FORMATS[name]).parameters


def need(package: str, option: str) -> Any:
    """Import a package of the extra `export` that a command-line option needs.

    Raises:
        BadInput: the package is not installed.
    """
    try:
        return import_module(package)
    except ImportError as error:
        name = package.split(".")[0]
        raise BadInput(f"{option} needs the package {name}: pip install {name}") from error
