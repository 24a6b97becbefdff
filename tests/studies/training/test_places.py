"""Training on made-up samples, whose patches tell the offset plainly."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.studies.training import places, specification
from peopleboy.studies.training.panorama_sequences import panorama_calibration
from peopleboy.studies.training.places import DenseRecipe, PlaceSamples, PlacesTraining, fit_places
from peopleboy.tracker.sensors.panorama.figure_patch import PATCH
from peopleboy.tracker.sensors.panorama.place_model import PlaceModel
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.images.cardboard import CAMERA, VIEW


def plain(seed: int, number: int = 300) -> PlaceSamples:
    """A third shows nobody; of the others two cells tell the offset, the second one not surely."""
    rng = np.random.default_rng(seed)
    patches = rng.uniform(0.0, 0.1, (number, PATCH))
    offset = rng.uniform(-0.3, 0.3, (number, 2))
    nobody = rng.random(number) < 1 / 3
    patches[:, :40] += np.where(nobody, 0.0, 0.8)[:, None]
    patches[:, 100:130] += (offset[:, :1] + 0.3) * ~nobody[:, None]
    patches[:, 200:230] += (offset[:, 1:] + 0.3) * ~nobody[:, None]
    told = offset + rng.normal(0.0, (0.01, 0.2), (number, 2))
    return PlaceSamples(
        patches.astype(np.float16), rng.uniform(1.0, 7.0, number), np.where(nobody[:, None], np.nan, told)
    )


@pytest.mark.slow
def test_it_learns_who_is_there_where_and_how_sure_that_is() -> None:
    told, test = plain(0, 1500), plain(1)
    seen = fit_places(told, VIEW).look(test.patches.astype(np.float32), test.distance_m)
    assert np.mean((seen.evidence > 0) == test.is_person) > 0.98
    off = np.abs(seen.offset_m - test.offset_m)[test.is_person]
    assert off[:, 0].mean() < 0.08
    assert off[:, 0].mean() < off[:, 1].mean() < 0.3
    believed = seen.deviation_m[test.is_person]
    assert np.median(believed[:, 0]) < 0.8 * np.median(believed[:, 1])
    assert 0.4 < np.mean((off / believed) ** 2) < 2.5


@pytest.mark.thorough
def test_the_same_examples_give_the_same_networks() -> None:
    one, two = (fit_places(plain(0), VIEW) for _ in range(2))
    for name in ("presence", "place", "doubt"):
        for ours, theirs in zip(getattr(one, name).layers, getattr(two, name).layers, strict=True):
            assert all(np.array_equal(a, b) for a, b in zip(ours, theirs, strict=True))


def test_without_jax_it_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "jax", None)
    monkeypatch.delitem(sys.modules, places.__name__)
    assert_names(refusal(capsys, "train", "places", "--out", tmp_path / "out"), "places", "pip install jax")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which all examples are there."""
    monkeypatch.setattr(places, "VALIDATION", 1)
    for name, epochs in (("PLACE", 1), ("PRESENCE", 4), ("DOUBT", 1)):
        recipe: DenseRecipe = getattr(places, name)
        monkeypatch.setattr(places, name, recipe._replace(epochs=epochs))
    monkeypatch.setattr(places, "LIBRARY", {"room_long": 1})
    training = PlacesTraining(sequences=2, rendered=tmp_path / "films")
    tasks = training.tasks(tmp_path / "out")
    assert [task.name for part in tasks for task in part] == [
        "scene_100", "scene_101", "room_long_100", "scene_0",
    ]  # fmt: skip
    for task in (*tasks.training, *tasks.validation):
        task.path.parent.mkdir(parents=True, exist_ok=True)
        plain(task.arguments[1]).save(task.path)
    return tmp_path


def train(folder: Path, *more: object) -> int:
    return run_cli(
        "train",
        "places",
        "--seeds",
        2,
        "--workers",
        1,
        "--out",
        folder / "out",
        "--rendered",
        folder / "films",
        *more,
    )


def test_it_leaves_a_model_that_knows_its_camera_and_films_nothing_anew(folder: Path) -> None:
    assert train(folder) == 0
    path = folder / "out" / "places.npz"
    model = PlaceModel.load(path)
    assert model.view.refusal(VIEW) == ""
    assert list((folder / "films").rglob("*.npz")) == []
    assert model.look(plain(5).patches.astype(np.float32), plain(5).distance_m).evidence.shape == (300,)


def test_shipped_it_lies_where_the_tracker_looks(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(specification.Specification, "SHIPPED_IN", folder / "shipped")
    assert train(folder, "--ship") == 0
    assert PlaceModel.load(folder / "shipped" / "places.npz").view.refusal(VIEW) == ""
    assert not (folder / "out" / "places.npz").exists()


def test_a_folder_that_cannot_be_written_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("in the way")
    for options in (
        ("--out", tmp_path / "file" / "out"),
        ("--out", tmp_path / "o", "--rendered", tmp_path / "file"),
    ):
        assert_names(refusal(capsys, "train", "places", *options), "file", "cannot write here")


def test_the_camera_is_the_usual_one() -> None:
    found = panorama_calibration(load_scenario("room_long"), 0)
    assert (found.width, found.height) == (CAMERA.width, CAMERA.height)
    assert found.focal_px == pytest.approx(CAMERA.focal_px, rel=1e-3)
