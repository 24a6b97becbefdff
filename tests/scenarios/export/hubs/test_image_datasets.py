"""Data sets for hubs are read by the hubs' own libraries."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from tests.helpers.runs.exported import export

# The libraries use deprecated parts of others, and leave files to the garbage collector.
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]


@pytest.fixture(scope="module")
def truth(coco_folder: Path) -> dict[str, Any]:
    """The same run as a COCO set."""
    loaded: dict[str, Any] = json.loads((coco_folder / "annotations" / "person_keypoints.json").read_text())
    return loaded


@pytest.fixture(scope="module")
def shards(crossing: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(crossing, "webdataset", tmp_path_factory.mktemp("hub") / "webdataset")


@pytest.fixture(scope="module")
def tables(crossing: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("datasets")
    return export(crossing, "huggingface", tmp_path_factory.mktemp("hub") / "huggingface")


def image_of(crossing: Path, frame: int) -> np.ndarray[Any, Any]:
    return np.asarray(cv2.imread(str(crossing / "thermal" / f"{frame:06d}.png"), cv2.IMREAD_UNCHANGED))


def test_webdataset_reads_images_masks_and_labels(
    shards: Path, crossing: Path, truth: dict[str, Any]
) -> None:
    webdataset = pytest.importorskip("webdataset")
    files = sorted(map(str, shards.glob("*.tar")))
    found = list(webdataset.WebDataset(files, shardshuffle=False).decode("l8"))
    assert len(found) == len(truth["images"])
    for sample, image in zip(found, truth["images"], strict=True):
        frame = image["frame_id"]
        assert sample["__key__"] == f"{crossing.name}-{frame:06d}"
        assert np.array_equal(sample["png"], image_of(crossing, frame))
        ours = [one for one in truth["annotations"] if one["image_id"] == image["id"]]
        assert [one["bbox"] for one in sample["json"]["annotations"]] == [one["bbox"] for one in ours]
        mask = sample["mask.png"]
        assert [int((mask == one["track_id"]).sum()) for one in ours] == [one["area"] for one in ours]


def test_datasets_reads_images_masks_and_labels(
    tables: Path, crossing: Path, truth: dict[str, Any], tmp_path: Path
) -> None:
    datasets = pytest.importorskip("datasets")
    found = datasets.load_dataset(str(tables / "data"), cache_dir=str(tmp_path))["train"]
    assert len(found) == len(truth["images"])
    for row, image in zip(found, truth["images"], strict=True):
        assert np.array_equal(np.asarray(row["image"]), image_of(crossing, image["frame_id"]))
        ours = [one for one in truth["annotations"] if one["image_id"] == image["id"]]
        for name in ("bbox", "area", "track_id", "posture", "visible_fraction"):
            assert row["objects"][name] == [one[name] for one in ours]
        assert row["objects"]["sex"] == [one["attributes"]["sex"] for one in ours]
    assert found.features["objects"]["category"].feature.names == ["person"]


@pytest.mark.parametrize("form", ["shards", "tables"])
def test_croissant_reads_the_images(form: str, request: pytest.FixtureRequest, crossing: Path) -> None:
    croissant = pytest.importorskip("mlcroissant")
    folder: Path = request.getfixturevalue(form)
    found = croissant.Dataset(jsonld=folder / "croissant.json")
    (records,) = found.metadata.record_sets
    rows = list(found.records(record_set=records.uuid))
    assert not found.metadata.ctx.issues.errors
    images = [row[f"{records.uuid}/image"] for row in rows]
    first = image_of(crossing, 1)
    assert any(np.array_equal(np.asarray(image), first) for image in images)
    assert len(images) in (60, 120)
