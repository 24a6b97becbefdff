"""Instance, part and depth images agree with the tables, and with the masks of COCO."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
from numpy.typing import NDArray

from peopleboy.scenarios.export.replay import replay
from peopleboy.scenarios.run_folder.finished_run import open_run
from tests.helpers.runs.exported import export

FRAMES = (1, 9)


@pytest.fixture(scope="module")
def folder(crossing: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(crossing, "images", tmp_path_factory.mktemp("images") / "set") / crossing.name


def read(path: Path) -> NDArray[np.uint16]:
    found = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert found is not None
    return np.asarray(found, np.uint16)


@pytest.mark.slow
@pytest.mark.parametrize("camera", ["thermal", "colour"])
def test_boxes_and_pixels_of_the_table_are_those_of_the_instance_image(
    camera: str, folder: Path, crossing: Path
) -> None:
    table = pq.read_table(
        crossing / ("truth.parquet" if camera == "thermal" else f"truth/{camera}.parquet")
    ).to_pylist()
    compared = 0
    for row in table:
        mask = read(folder / f"truth/{camera}/instance/{row['frame']:06d}.png") == row["id"]
        assert mask.sum() == row["visible_px"]
        if row["visible_px"]:
            v, u = np.nonzero(mask)
            around = (u.min() - 0.5, v.min() - 0.5, np.ptp(u) + 1, np.ptp(v) + 1)
            told = [row[f"visible_{edge}_px"] for edge in ("left", "top", "width", "height")]
            assert told == pytest.approx(around, abs=0.01)
            compared += 1
    assert compared > 60


def test_parts_cover_people_and_names_are_told(folder: Path) -> None:
    numbers = json.loads((folder / "truth" / "numbers.json").read_text())
    assert numbers["instance"] == {"anna": 1, "ben": 2}
    for frame in FRAMES:
        parts, people = (
            read(folder / f"truth/colour/{kind}/{frame:06d}.png") for kind in ("body_part", "instance")
        )
        assert np.array_equal(parts > 0, people > 0)
        assert set(np.unique(parts[parts > 0]).tolist()) <= set(numbers["body_part"].values())


@pytest.mark.slow
def test_depth_is_true_to_half_a_millimetre_and_images_are_those_of_the_run(
    folder: Path, crossing: Path
) -> None:
    for tick in replay(open_run(crossing)):
        if tick.frame not in FRAMES:
            continue
        name = f"{tick.frame:06d}.png"
        for camera, truth in tick.truths.items():
            depth = read(folder / "truth" / camera / "depth" / name)
            assert depth / 1000.0 == pytest.approx(truth.depth_m, abs=0.00051)
        for kind in ("thermal", "thermal16", "thermal_scene", "colour"):
            assert np.array_equal(read(folder / kind / name), read(crossing / kind / name))
        if tick.frame == FRAMES[-1]:
            return
