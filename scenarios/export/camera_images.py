"""The images that one camera took in a run, as files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from peopleboy.scenarios.export.one_camera import OneCamera
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.run_folder.image_files import image_file, write_png


def write_camera_images(shots: OneCamera, play: Play, place: Callable[[int], Path]) -> None:
    """Copy a camera's images if the run has written them, else render them again.

    Args:
        shots: the camera and its run.
        play: gives the run's ticks.
        place: names the file of an image by its number, from 1.

    Raises:
        BadInput: a file cannot be written, or the run does not come out as it was.
    """
    written = [shots.run.folder / shots.name / image_file(frame) for frame in shots.frames]
    if all(path.is_file() for path in written):
        for number, path in enumerate(written, start=1):
            place(number).write_bytes(path.read_bytes())
        return
    for tick in play(shots.run):
        if tick.frame in shots.frames:
            write_png(place(shots.number(tick.frame)), tick.observation.images[shots.name])
