"""Files of machines that tell humans by their windows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.sensors.depth.human_windows import WindowRange, depth_features, features
from peopleboy.tracker.sensors.depth.window_model import WindowModel, feature_length, shipped_windows


def make_model(extra: int = 0) -> WindowModel:
    rng = np.random.default_rng(3)
    return WindowModel(
        {kind: rng.normal(size=feature_length(kind) + 1 + extra).astype(np.float32) for kind in WindowRange},
        {"trained on": "nothing"},
    )


def test_a_model_comes_back_from_its_file(tmp_path: Path) -> None:
    model = make_model()
    model.save(tmp_path / "windows.npz")
    read = WindowModel.load(tmp_path / "windows.npz", sees_depth=False)
    assert read.about == model.about
    assert all(np.array_equal(read.weights[kind], model.weights[kind]) for kind in WindowRange)


def test_a_score_is_the_distance_from_a_plane() -> None:
    model, seen = make_model(), np.ones(feature_length(WindowRange.NEAR), np.float32)
    weights = model.weights[WindowRange.NEAR].astype(float)
    assert model.score(seen, WindowRange.NEAR) == pytest.approx(weights.sum(), rel=1e-4)


def test_machines_of_another_window_are_refused(tmp_path: Path) -> None:
    make_model(extra=36).save(tmp_path / "other.npz")
    with pytest.raises(BadInput, match=r"other\.npz: near must be finite float32 \(1765,\)"):
        WindowModel.load(tmp_path / "other.npz", sees_depth=False)


def test_a_missing_file_names_the_command(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="peopleboy train windows"):
        WindowModel.load(tmp_path / "none.npz", sees_depth=True)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 broken", b"far: [1, 2]"])
def test_what_is_no_model_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "bad.npz").write_bytes(content)
    with pytest.raises(BadInput, match="not a file of weights"):
        WindowModel.load(tmp_path / "bad.npz", sees_depth=False)


def test_numbers_that_are_not_finite_are_refused(tmp_path: Path) -> None:
    model = make_model()
    model.weights[WindowRange.FAR][7] = np.nan
    model.save(tmp_path / "nan.npz")
    with pytest.raises(BadInput, match="finite"):
        WindowModel.load(tmp_path / "nan.npz", sees_depth=False)


@pytest.mark.parametrize("sees_depth", [False, True])
def test_the_models_that_are_shipped_say_what_they_were_trained_on(sees_depth: bool) -> None:
    model = shipped_windows(sees_depth=sees_depth)
    assert "seeds from 100" in model.about["trained on"]
    assert model.sees_depth is sees_depth


@pytest.mark.parametrize("sees_depth", [False, True])
@pytest.mark.parametrize("kind", list(WindowRange))
def test_a_look_adds_what_colour_and_depth_say(kind: WindowRange, sees_depth: bool) -> None:
    rng, window = np.random.default_rng(1), (30.0, 20.0, 60.0, 120.0)
    colour = rng.integers(0, 255, (240, 320, 3)).astype(np.uint8)
    depth = rng.integers(2500, 3500, (240, 320)).astype(np.uint16)
    model, count = shipped_windows(sees_depth=sees_depth), feature_length(kind)
    weights = model.weights[kind].astype(float)
    expected = weights[:count] @ features(colour, window, kind) + weights[-1]
    if sees_depth:
        expected += weights[count:-1] @ depth_features(depth, 3.0, window, kind)
    assert model.look(colour, depth, 3.0, window, kind) == pytest.approx(expected, abs=1e-4)
