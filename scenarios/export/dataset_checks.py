"""Check a rendered set against its datasheet."""

import hashlib
import json
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
import pyarrow.parquet as pq

from peopleboy.scenarios.export.splits import SPLITS, split_file
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.run_folder.finished_run import cameras_of
from peopleboy.scenarios.run_folder.image_files import image_file
from peopleboy.scenarios.run_folder.run_tables import LOCAL
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.running.sample_run import sample_run
from peopleboy.sim.cameras.kinds import image_folders

_ROUNDING = 1e-9
_AGAIN_FRAMES = 3
_CORNER_PX = -0.5  # of the first pixel
_HALF_PX = 0.5  # boxes extend half a pixel beyond the centres of their pixels


_Look = dict[str, tuple[tuple[int, ...] | None, bool]]  # by file: shape, and whether all pixels are equal


@dataclass(frozen=True, slots=True)
class Check:
    """One check of a rendered set.

    Attributes:
        what: the condition that should hold.
        failures: violations, one line each; empty if the condition holds.
    """

    what: str
    failures: tuple[str, ...]


def check_set(folder: Path, runs: Sequence[Path], first: Scenario, options: RunOptions) -> list[Check]:
    """Run all checks; those of images only if the set has images.

    Args:
        folder: folder of the set, with its splits.
        runs: folders of the runs.
        first: scenario of the first run, which is rendered again.
        options: options of that run.
    """
    of_images = "every image exists with the right size, and none is uniform"
    images = [_each(of_images, runs, _check_images)] if options.frames else []
    return [
        *images,
        _each("the visible and hidden fractions of each person sum to one", runs, _check_shares),
        _each(
            "visible boxes lie inside whole boxes, to half a pixel, and inside the image", runs, _check_boxes
        ),
        Check("no two runs have the same ground truth", tuple(_twins(runs))),
        Check("every run is in exactly one split", tuple(_check_splits(folder, runs))),
        Check(
            f"the first run, repeated, gives the same {'images, ' * options.frames}boxes and tracks",
            tuple(_check_again(runs[0], first, options)),
        ),
    ]


def _each(what: str, runs: Sequence[Path], look: Callable[[Path], list[str]]) -> Check:
    return Check(what, tuple(f"{run.name}: {failure}" for run in runs for failure in look(run)))


def _check_images(run: Path) -> list[str]:
    about = json.loads((run / "run.json").read_text(encoding="utf-8"))
    wrong = []
    for name, camera in cameras_of(run).items():
        every = about["rate_hz"] // (camera.rate_hz or about["rate_hz"])
        kept = about.get("kept_frames", range(1, about["frames"] + 1))
        frames = [frame for frame in kept if (frame - 1) % every == 0]
        views = [_look_into(run / folder) for folder, _, _ in image_folders({name: camera})]
        wrong += [f"{name}: {fault}" for look in views for fault in _faults(look, frames)]
        # A cold scene can be black in the 8-bit image, while the other images still have content.
        plain = set.intersection(*(_plain(look) for look in views))
        wrong += [f"{name}: {file} has no content" for file in sorted(plain)]
    return wrong


def _look_into(folder: Path) -> _Look:
    """Return for each image in a folder its shape, None if unreadable, and whether all pixels are equal."""
    return {path.name: _look_at(path) for path in sorted(folder.glob("*.png"))}


def _look_at(path: Path) -> tuple[tuple[int, ...] | None, bool]:
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    return (None, False) if image is None else (image.shape, bool(image.min() == image.max()))


def _plain(look: _Look) -> set[str]:
    return {file for file, (_, is_plain) in look.items() if is_plain}


def _faults(look: _Look, frames: Sequence[int]) -> Iterator[str]:
    """Yield the faults of a folder that should have the images of these frames."""
    if list(look) != [image_file(frame) for frame in frames]:
        yield f"{len(look)} images for {len(frames)} frames"
    shapes = {shape for shape, _ in look.values()}
    if len(shapes) > 1 or None in shapes:
        yield "images of several sizes, or unreadable"


def _check_shares(run: Path) -> list[str]:
    table = pq.read_table(
        (run / "truth.parquet").absolute(),
        columns=["frame", "visible_fraction", "hidden_by", "whole_px"],
        filesystem=LOCAL,
    )
    return [
        f"frame {row['frame']}: shares sum to {total:.6f}"
        for row in table.to_pylist()
        if row["whole_px"]
        and abs((total := row["visible_fraction"] + sum(share for _, share in row["hidden_by"])) - 1.0)
        > _ROUNDING
    ]


def _check_boxes(run: Path) -> list[str]:
    table = pq.read_table(
        (run / "truth.parquet").absolute(), filters=[("visible_px", ">", 0)], filesystem=LOCAL
    )
    inner, outer = (
        np.array([table[f"{which}_{edge}_px"].to_numpy() for edge in ("left", "top", "width", "height")])
        for which in ("visible", "whole")
    )
    is_out = (inner[:2] < outer[:2] - _HALF_PX - _ROUNDING).any(axis=0)
    is_out |= (inner[:2] + inner[2:] > outer[:2] + outer[2:] + _HALF_PX + _ROUNDING).any(axis=0)
    is_out |= (inner[:2] < _CORNER_PX - _ROUNDING).any(axis=0)
    return [f"frame {frame}: visible box outside" for frame in table["frame"].to_numpy()[is_out]]


def _twins(runs: Sequence[Path]) -> list[str]:
    seen: dict[str, str] = {}
    return [
        f"{run.name} is {first}"
        for run in runs
        if (first := seen.setdefault(_digest(run / "truth" / "gt.txt"), run.name)) != run.name
        and (run / "truth" / "gt.txt").stat().st_size
    ]


def _check_splits(folder: Path, runs: Sequence[Path]) -> list[str]:
    files = [split_file(folder, split).read_text(encoding="utf-8").split() for split in SPLITS]
    named = Counter(name for names in files for name in names)
    return [f"{run.name}: in {named[run.name]} splits" for run in runs if named[run.name] != 1]


def _check_again(done: Path, scenario: Scenario, options: RunOptions) -> list[str]:
    """Repeat the run, and compare every image and every line of text."""
    rate_hz = json.loads((done / "run.json").read_text())["rate_hz"]
    entries_s = [person.enter_s for person in scenario.people(options.seed)]
    lasts_s = max(_AGAIN_FRAMES / rate_hz, *(entry + 1.0 / rate_hz for entry in entries_s), 0.0)
    with tempfile.TemporaryDirectory() as scratch:
        again = Path(scratch) / "again"
        if options.choice is None:
            run(scenario.lasting(lasts_s), replace(options, out=again), lambda _tick, _frames: None)
        else:  # which frames are chosen depends on the length of the run
            sample_run(scenario, replace(options, out=again), lambda _frame: None)
        folders = [folder for folder, _, _ in image_folders(cameras_of(again))]
        files = [path for folder in folders for path in sorted((again / folder).glob("*.png"))]
        wrong = [
            f"{path.parent.name}/{path.name} differs"
            for path in files
            if path.read_bytes() != (done / path.parent.name / path.name).read_bytes()
        ]
        wrong += [
            f"{name} differs"
            for name in ("truth/gt.txt", "tracks.txt")
            if not (done / name).read_bytes().startswith((again / name).read_bytes())
        ]
    return wrong


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
