from __future__ import annotations

import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.training.detector import crop_samples
from peopleboy.studies.training.detector.crop_samples import (
    CropSamples,
    augment_crops,
    fit_crops,
    later_seeds,
    mean_overlaps,
    network_outputs,
    seed_of,
)
from peopleboy.studies.training.detector.train_box_refinement import BoxRefinementTraining
from peopleboy.studies.training.detector.train_rescoring import RescoringTraining
from peopleboy.studies.training.detector.worlds import KINDS, LATER, seeds_of, world_of
from peopleboy.studies.training.samples import SampleTask, collect_missing
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.networks.inference import CropNetwork
from peopleboy.tracker.sensors.thermal.detector.box_regression import decode_boxes
from peopleboy.tracker.sensors.thermal.detector.crops import CHANNELS, SCORES, normalise_crops
from peopleboy.tracker.sensors.thermal.detector.rescoring import BoxRefinementNetwork, RescoringNetwork
from tests.helpers.calls.command_line import run_cli
from tests.helpers.calls.refused import refused
from tests.helpers.images.drawn_crops import drawn_crops, drawn_weights
from tests.helpers.images.drawn_films import drawn_film

LINE = {"line": np.array([1.0, 0.0], np.float32)}


@pytest.mark.parametrize("kind", [RescoringNetwork, BoxRefinementNetwork])
def test_what_is_taught_is_what_the_tracker_computes(kind: type[CropNetwork]) -> None:
    looks, weights = drawn_crops(kind.ARCHITECTURE, 4), drawn_weights(kind.ARCHITECTURE)
    planes = normalise_crops(looks.crops)
    ours = kind(weights).outputs(planes, looks.features)
    np.testing.assert_allclose(
        np.asarray(jax.jit(partial(network_outputs, kind.ARCHITECTURE))(weights, planes, looks.features)),
        ours,
        atol=1e-3,
    )


@pytest.mark.thorough
@pytest.mark.usefixtures("small")
def test_people_are_told_from_others_after_a_short_lesson() -> None:
    form = RescoringNetwork.ARCHITECTURE
    weights = fit_crops(form, RescoringTraining().loss, drawn_crops(form, 320), epochs=8, dropout=0.4)
    others = drawn_crops(form, 200, seed=5)
    ours = RescoringNetwork(weights | LINE).predict(normalise_crops(others.crops), others.features)
    before = SCORES * others.features[:, 0]
    is_person = others.overlap > 0.5
    assert np.mean((before > 0.0) == is_person) < 0.7
    assert np.mean((ours[:, 0] > 0.0) == is_person) > 0.95


@pytest.mark.thorough
@pytest.mark.usefixtures("small")
def test_where_people_are_is_told_after_a_short_lesson() -> None:
    form = BoxRefinementNetwork.ARCHITECTURE
    looks, others = (drawn_crops(form, *drawn, targets=6) for drawn in ((512,), (80, 5)))
    looks, others = (each.take(np.flatnonzero(each.overlap > 0.5)) for each in (looks, others))
    weights = fit_crops(form, BoxRefinementTraining().loss, looks, epochs=20, dropout=0.2)
    aside = BoxRefinementNetwork(weights).predict(normalise_crops(others.crops), others.features)[:, 0]
    assert np.corrcoef(aside, others.offsets[:, 0])[0, 1] > 0.9


@pytest.mark.thorough
@pytest.mark.usefixtures("small")
def test_the_same_lesson_gives_the_same_network() -> None:
    form = RescoringNetwork.ARCHITECTURE
    looks = drawn_crops(form, 128)
    one, same = (fit_crops(form, RescoringTraining().loss, looks, epochs=1, dropout=0.4) for _ in range(2))
    for name, weights in one.items():
        np.testing.assert_array_equal(same[name], weights)


def test_mirrored_people_have_their_edges_on_the_other_side() -> None:
    looks = drawn_crops(BoxRefinementNetwork.ARCHITECTURE, 5, targets=6)
    left, right = looks.offsets[:, 4], looks.offsets[:, 5]
    mirrored = looks.mirror()
    np.testing.assert_array_equal(mirrored.offsets[:, 4:], np.stack([-right, -left], axis=1))
    np.testing.assert_array_equal(mirrored.offsets[:, 0], -looks.offsets[:, 0])
    np.testing.assert_array_equal(mirrored.mirror().offsets, looks.offsets)


def test_unknown_edges_do_not_change_the_loss() -> None:
    training, form = BoxRefinementTraining(), BoxRefinementNetwork.ARCHITECTURE
    looks = drawn_crops(form, 6, targets=6)
    unknown = looks.offsets.copy()
    unknown[:, 4:] = np.nan
    outputs = jnp.asarray(np.random.default_rng(1).normal(0.0, 1.0, (6, 6)))
    other = outputs.at[:, 4:].add(3.0)
    hidden = replace(looks, offsets=unknown)
    assert training.loss(outputs, hidden)[0] == training.loss(other, hidden)[0]
    assert training.loss(outputs, looks)[0] != training.loss(other, looks)[0]


def test_too_little_to_learn_from_is_refused() -> None:
    form = RescoringNetwork.ARCHITECTURE
    with refused("10 samples", "at least 64"):
        fit_crops(form, RescoringTraining().loss, drawn_crops(form, 10), epochs=1, dropout=0.4)


vary = jax.jit(augment_crops)

OUTSIDE = 25  # the first row that is below the image


def drawn_planes(count: int, rows: int = 32, columns: int = 24) -> np.ndarray:
    planes = np.random.default_rng(0).normal(0.0, 1.0, (count, rows, columns, CHANNELS)).astype(np.float32)
    planes[..., 1] = np.abs(planes[..., 1])
    planes[..., 2] = 1.0
    planes[:, OUTSIDE:] = 0.0  # below the image
    return planes


@pytest.mark.slow
@pytest.mark.parametrize(("rows", "columns"), [(32, 24), pytest.param(40, 36, marks=pytest.mark.thorough)])
def test_what_is_outside_the_image_stays_outside(rows: int, columns: int) -> None:
    planes = drawn_planes(400, rows, columns)
    after = np.asarray(vary(planes, jax.random.key(1)))
    assert after.shape == planes.shape
    np.testing.assert_array_equal(after[..., 2], planes[..., 2])
    assert not after[:, OUTSIDE:].any()


def test_some_crops_are_covered_and_some_stand_still() -> None:
    planes = drawn_planes(400)
    after = np.asarray(vary(planes, jax.random.key(2)))
    is_still = ~after[..., 1].any(axis=(1, 2))
    assert 0.08 < is_still.mean() < 0.25
    moves = after[~is_still][:, :OUTSIDE, :, 1]
    covered = (moves == 0.0).mean(axis=(1, 2))
    assert 0.08 < (covered > 0.01).mean() < 0.35
    assert covered.max() < 0.5


def test_the_same_key_gives_the_same() -> None:
    planes = drawn_planes(400)
    one, same, other = (np.asarray(vary(planes, jax.random.key(key))) for key in (5, 5, 6))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)


def test_overlap_of_offsets_is_that_of_the_boxes() -> None:
    rng = np.random.default_rng(0)
    told, true = (rng.normal(0.0, 0.03, (20, 4)) + np.array([0.0, 0.0, 0.0, 0.22]) for _ in range(2))
    before = rng.random(20).astype(np.float32)
    none = CropSamples.empty(BoxRefinementNetwork.ARCHITECTURE.crop, BoxRefinementTraining.TARGETS)
    looks = replace(none, offsets=true.astype(np.float32), overlap=before)
    window = np.tile([40.0, 50.0, 30.0, 80.0], (20, 1))
    expected = iou(decode_boxes(window, told), decode_boxes(window, true))
    rows = np.arange(20) > 6
    assert mean_overlaps(told, looks, rows) == pytest.approx(
        (before[rows].mean(), expected[rows].mean()), rel=1e-5
    )


def test_later_worlds_are_of_the_same_kinds_and_no_trees_were_trained_on_them() -> None:
    seeds = later_seeds(2000)
    assert len(seeds) == len(set(seeds)) == 2000
    assert not set(seeds_of(1500)) & set(seeds)
    crowd = KINDS[1]
    assert world_of(LATER + crowd.first_seed) == crowd.draw(LATER + crowd.first_seed)


def test_one_of_ten_is_held_back_and_sequences_that_are_there_are_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[int] = []

    def render(seed: int) -> object:
        made.append(seed)
        return drawn_film(0, 1)

    def task(folder: Path, seed: int) -> SampleTask:
        return SampleTask(folder / f"world_{seed}.npz", render, (seed,))  # type: ignore[arg-type]

    monkeypatch.setattr(crop_samples, "render_task", task)
    first, again = (BoxRefinementTraining(sequences=100).tasks(tmp_path) for _ in range(2))
    for tasks in (first, again):
        collect_missing(tasks, Workers(1))
    assert sorted(made) == sorted(later_seeds(100))
    assert [one.path for one in first.training] == [one.path for one in again.training]
    assert all(seed_of(one) % 10 == 9 for one in first.validation)
    assert len(first.training) + len(first.validation) == 100


@pytest.mark.thorough
@pytest.mark.usefixtures("small", "drawn")
@pytest.mark.parametrize(
    ("model", "network", "result"),
    [
        ("rescoring", RescoringNetwork, "log loss"),
        ("box-refinement", BoxRefinementNetwork, "mean IoU"),
    ],
)
def test_training_leaves_a_network_that_says_how_good_it_is(
    model: str,
    network: type[RescoringNetwork | BoxRefinementNetwork],
    result: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(crop_samples, "BATCH", 8)
    assert run_cli("train", model, "--seeds", 10, "--epochs", 1, "--out", tmp_path, "--workers", 1) == 0
    about = network.load(tmp_path / f"{model}.npz").about
    assert about["trained on"].startswith("9 sequences, ")
    assert result in about["on 1 other sequences"]


@pytest.mark.usefixtures("drawn")
def test_training_that_cannot_be_evaluated_is_refused_before_it_begins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    none = CropSamples.empty(BoxRefinementNetwork.ARCHITECTURE.crop, BoxRefinementTraining.TARGETS)
    monkeypatch.setattr(BoxRefinementTraining, "sample", lambda *_, **__: none)
    chosen = ("--seeds", 10, "--out", tmp_path, "--workers", 1)
    assert run_cli("train", "box-refinement", *chosen) == 2
    assert "no people are visible in the validation sequences" in capsys.readouterr().err
    assert not (tmp_path / "box-refinement.npz").exists()


@pytest.mark.parametrize("model", ["rescoring", "box-refinement"])
def test_without_jax_training_says_what_is_missing(
    model: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "optax", None)
    for name in [name for name in sys.modules if name.startswith("peopleboy.studies.training")]:
        monkeypatch.delitem(sys.modules, name)
    assert run_cli("train", model, "--out", tmp_path / "out") == 2
    assert "pip install optax" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
