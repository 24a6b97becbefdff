"""What cameras' images are like, in words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.config import CONTROL_HZ


def describe_images(outfits: Iterable[Mapping[str, CameraConfig]]) -> str:
    """Say how large cameras' images are, how many a second, and of which cameras if they differ.

    Args:
        outfits: the cameras of each robot.
    """
    names: dict[str, dict[str, None]] = {}
    for name, config in (pair for cameras in outfits for pair in cameras.items()):
        camera = config.camera
        words = f"{camera.width}x{camera.height} pixels, {config.rate_hz or CONTROL_HZ} a second"
        names.setdefault(words, {})[name] = None
    if len(names) == 1:
        return next(iter(names))
    return ", or ".join(f"{words} ({', '.join(own)})" for words, own in names.items())
