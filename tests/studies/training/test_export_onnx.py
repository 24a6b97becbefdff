"""Exported networks give what the trackers' own inference gives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from peopleboy.studies.training.export_onnx import NETWORKS, export_onnx
from peopleboy.tracker.networks.inference import CropNetwork
from peopleboy.tracker.networks.mask_network import INPUTS
from peopleboy.tracker.reproductions.panoramic.distance_network import shipped_models
from peopleboy.tracker.sensors.panorama.people_foreground import shipped_foreground
from peopleboy.tracker.sensors.panorama.place_model import PlaceModel
from peopleboy.tracker.sensors.thermal.detector.rescoring import BoxRefinementNetwork, RescoringNetwork
from tests.helpers.calls.command_line import refusal, run_cli

runtime = pytest.importorskip("onnxruntime")
pytest.importorskip("onnx")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("onnx")
    assert [path.name for path in export_onnx((), out)] == [*(f"{n}.onnx" for n in NETWORKS), "README.md"]
    return out


def outputs(folder: Path, name: str, **inputs: np.ndarray) -> list[np.ndarray]:
    session = runtime.InferenceSession(folder / f"{name}.onnx", providers=["CPUExecutionProvider"])
    return session.run(None, inputs)


def draw(*shape: int) -> np.ndarray:
    return np.random.default_rng(0).uniform(-1.0, 1.0, shape).astype(np.float32)


@pytest.mark.parametrize("kind", [RescoringNetwork, BoxRefinementNetwork])
def test_networks_on_crops_agree(folder: Path, kind: type[CropNetwork]) -> None:
    network, shape = kind.shipped(), kind.ARCHITECTURE
    crops, features = draw(3, shape.crop.rows, shape.crop.columns, 3), draw(3, shape.features)
    (found,) = outputs(folder, kind.MODEL, crops=crops, features=features)
    np.testing.assert_allclose(found, network.outputs(crops, features), atol=1e-4)


def test_networks_of_places_agree(folder: Path) -> None:
    model = PlaceModel.load()
    inputs = draw(4, len(model.presence.layers[0][0]))
    presence, place, doubt = outputs(folder, "places", inputs=inputs)
    np.testing.assert_allclose(presence, model.presence.predict(inputs), atol=1e-4)
    np.testing.assert_allclose(place, model.place.predict(inputs), atol=1e-4)
    np.testing.assert_allclose(doubt, model.doubt.predict(inputs), atol=1e-4)


def test_networks_of_distances_agree_and_none_is_missing(folder: Path) -> None:
    models = {path.stem: model for path, model in shipped_models().items()}
    assert list(models) == [name for name in NETWORKS if name.startswith("distance-")]
    for name, model in models.items():
        ranges = model.network.cue_ranges
        share = np.random.default_rng(0).uniform(-0.2, 1.2, (50, 3))  # also beyond those of training
        cues = ranges[:, 0] + share * (ranges[:, 1] - ranges[:, 0])
        (found,) = outputs(folder, name, cues=cues.astype(np.float32))
        np.testing.assert_allclose(found[:, 0], model.network.predict(cues), atol=1e-4)


def test_the_segmentation_agrees_also_over_the_seam(folder: Path) -> None:
    model = shipped_foreground()
    squares = draw(INPUTS, model.view.height_px // 4, model.view.width_px // 4)
    (found,) = outputs(folder, "foreground", squares=squares[None])
    np.testing.assert_allclose(found[0, 0], model.network.predict(squares), atol=1e-4)


def test_the_card_describes_every_tensor_and_the_training(folder: Path) -> None:
    card = (folder / "README.md").read_text()
    for name in NETWORKS:
        export = NETWORKS[name]()
        assert f"## {name}.onnx" in card
        assert all(f"`{tensor}`" in card for tensor in (*export.inputs, *export.outputs))
        assert all(key in card for key in export.about)


def test_the_command_exports_what_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli("export-onnx", "places", "--out", tmp_path) == 0
    assert capsys.readouterr().out.split() == [str(tmp_path / "places.onnx"), str(tmp_path / "README.md")]
    assert "choose from rescoring" in refusal(capsys, "export-onnx", "yolo")
