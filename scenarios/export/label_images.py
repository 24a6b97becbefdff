"""Labels as images: beside what each camera saw, whose each pixel is, of which part, and how far away.

RUN/CAMERA/000001.png, ...                   every image of every camera, as `run --frames` leaves them
RUN/truth/CAMERA/instance/000001.png         8 bits: number of the person seen, 0 for none
RUN/truth/CAMERA/body_part/000001.png        8 bits: number of the part of the body, 0 for none
RUN/truth/CAMERA/depth/000001.png            16 bits: true depth [mm], 0 for nothing and beyond 65 m
RUN/truth/numbers.json                       the name of each person and part
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import (
    image_file,
    make_image_folders,
    millimetres,
    write_images,
    write_png,
)
from peopleboy.sim.cameras.kinds import Stored
from peopleboy.sim.people.person import PART_CLASSES
from peopleboy.sim.truth.truth import Truth

KINDS: Final = ("instance", "body_part", "depth")


def write_label_images(runs: Sequence[FinishedRun], folder: Path, play: Play) -> None:
    """Write the images of each run, and what is true of each pixel.

    Raises:
        BadInput: a file cannot be written, or a run does not come out as it was.
    """
    for run in runs:
        own = folder / run.name
        cameras = run.robot.cameras
        make_image_folders(own, cameras)
        for place in (own / "truth" / camera / kind for camera in cameras for kind in KINDS):
            place.mkdir(parents=True)
        (own / "truth" / "numbers.json").write_text(json.dumps(_numbers(run), indent=2), encoding="utf-8")
        for tick in play(run):
            write_images(own, tick.frame, tick.observation, cameras)
            for camera, truth in tick.truths.items():
                for kind, image in label_images(truth).items():
                    write_png(own / "truth" / camera / kind / image_file(tick.frame), image)


def label_images(truth: Truth) -> dict[str, Stored]:
    """Give what is true of each pixel (H, W), by kind: numbers of 8 bits, and depth of 16 [mm]."""
    return dict(zip(KINDS, (truth.instance, truth.body_part, millimetres(truth.depth_m)), strict=True))


def _numbers(run: FinishedRun) -> Mapping[str, Mapping[str, int]]:
    people = {person.name: number for number, person in enumerate(run.world.people, start=1)}
    return {"instance": people, "body_part": PART_CLASSES}
