from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from peopleboy.studies.training.detector import augmentation, train_cascade
from peopleboy.studies.training.detector.boosting import Boosting
from peopleboy.studies.training.detector.evaluation import evaluate_trees
from peopleboy.studies.training.detector.mining import CELLS, patch_pool
from peopleboy.studies.training.detector.train_cascade import fit_boxes, fit_cascade
from peopleboy.studies.training.detector.world_sequences import ThermalImage
from peopleboy.studies.training.detector.worlds import KINDS
from peopleboy.studies.training.samples import SampleTask
from peopleboy.tracker.sensors.thermal.detector.box_regression import encode_boxes
from peopleboy.tracker.sensors.thermal.detector.channels import CHANNELS
from peopleboy.tracker.sensors.thermal.detector.patches import Patches, integrate, integrate_windows
from peopleboy.tracker.sensors.thermal.detector.people_trees import (
    PeopleModel,
    PeopleTrees,
    shipped_people_trees,
)
from peopleboy.tracker.sensors.thermal.detector.window import COLUMNS, ROWS, WindowKind
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.images.drawn_films import drawn_film


@pytest.fixture
def quick(drawn: None, monkeypatch: pytest.MonkeyPatch) -> None:  # noqa: ARG001
    """A short training on drawn sequences, of few trees."""
    rounds = (Boosting(3, 0.5, features=20), Boosting(4, 0.5, features=20))
    monkeypatch.setattr(train_cascade, "ROUNDS", dict.fromkeys(WindowKind, rounds))
    monkeypatch.setattr(train_cascade, "REGRESSION", Boosting(20, 0.3, features=60))
    monkeypatch.setattr(train_cascade, "VALIDATION", 2)
    monkeypatch.setattr(augmentation, "_CUT_TALL_PX", 40.0)


@pytest.fixture
def few_patches(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = patch_pool()
    some = Patches(whole.channel[::8], whole.first[::8], whole.second[::8])
    monkeypatch.setattr(train_cascade, "patch_pool", lambda: some)


@pytest.mark.thorough
@pytest.mark.usefixtures("quick", "few_patches")
def test_drawn_people_are_learned_and_found_in_other_images(shots: list[ThermalImage]) -> None:
    kind = WindowKind.WHOLE
    model = PeopleModel({kind: train_cascade.fit_trees(shots[:30], shots[30:36], kind)})
    found = evaluate_trees(model, shots[36:], knows_mount=False)
    assert (found.people, found.images) == (12, 12)
    assert found.recall(1.0) > 0.7
    assert found.overlap[found.is_person].mean() > 0.65


@pytest.mark.slow
@pytest.mark.usefixtures("quick", "few_patches")
def test_the_lesson_leaves_films_and_trees_and_says_how_good_they_are(tmp_path: Path) -> None:
    assert run_cli("train", "cascade", "--seeds", 5, "--out", tmp_path, "--workers", 1) == 0
    names = {path.name for path in (tmp_path / "sequences").iterdir()}
    assert names == {f"world_{seed}.npz" for seed in (0, 1, 1000, 1001, 2000, 3000, 4000, 5000, 6000)}
    about = PeopleModel.load(tmp_path / "cascade.npz").about
    trained_on = (
        "2 random worlds from seed 1000, 1 crowds from seed 2000, 1 worlds in the robot's own span "
        "from seed 3000, 1 plain worlds as warm as people from seed 4000, 1 crowds in the robot's own span "
        "from seed 5000, 1 worlds seen from above from seed 6000; 1 of them held out"
    )
    assert about["cut people"] == about["whole people"] == trained_on
    assert "average precision" in about["on worlds 0 to 1, mount known"]


@pytest.mark.thorough
@pytest.mark.usefixtures("quick")
def test_trees_that_are_not_taught_stay_as_they_are(tmp_path: Path) -> None:
    chosen = ("--seeds", 5, "--windows", "cut", "--workers", 1)
    assert run_cli("train", "cascade", *chosen, "--out", tmp_path) == 0
    taught, shipped = PeopleModel.load(tmp_path / "cascade.npz"), shipped_people_trees()
    before, after = (model.trees[WindowKind.WHOLE].cascade for model in (shipped, taught))
    np.testing.assert_array_equal(after.leaf, before.leaf, strict=True)
    assert len(taught.trees[WindowKind.CUT].cascade.leaf) == 4
    assert taught.about["whole people"] == shipped.about["whole people"]
    assert taught.about["cut people"].startswith("2 random worlds")


@pytest.mark.thorough
@pytest.mark.usefixtures("quick")
def test_places_alone_are_taught_for_the_trees_that_are_there(tmp_path: Path) -> None:
    chosen = ("--seeds", 5, "--windows", "whole", "--only-boxes", "--workers", 1)
    assert run_cli("train", "cascade", *chosen, "--out", tmp_path) == 0
    taught, shipped = PeopleModel.load(tmp_path / "cascade.npz"), shipped_people_trees()
    before, after = (model.trees[WindowKind.WHOLE] for model in (shipped, taught))
    np.testing.assert_array_equal(after.cascade.leaf, before.cascade.leaf, strict=True)
    assert not np.array_equal(after.regression.leaf, before.regression.leaf)
    np.testing.assert_array_equal(
        taught.trees[WindowKind.CUT].regression.leaf, shipped.trees[WindowKind.CUT].regression.leaf
    )
    assert taught.about["whole people"] == shipped.about["whole people"]
    assert taught.about["boxes of whole people"].startswith("2 random worlds")


def one_image(folder: Path, seed: int) -> SampleTask:
    return SampleTask(folder / f"world_{seed}.npz", drawn_film, (0, 1))


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(("worlds", "held"), [(5, 1), (10, 1), (40, 4)])
def test_a_tenth_of_the_worlds_is_held_back_and_at_least_one(
    worlds: int, held: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    split: list[int] = []

    def stop(shots: list[ThermalImage], others_of: list[ThermalImage], kind: WindowKind) -> PeopleTrees:
        assert kind is WindowKind.WHOLE
        split.extend((len(shots), len(others_of)))
        raise KeyboardInterrupt

    monkeypatch.setattr(train_cascade, "render_task", one_image)
    monkeypatch.setattr(train_cascade, "fit_trees", stop)
    run_cli("train", "cascade", "--seeds", worlds, "--out", tmp_path, "--workers", 1)
    assert split == [sum(len(kind.seeds(worlds)) for kind in KINDS) - held, held]


def test_too_few_worlds_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert_names(refusal(capsys, "train", "cascade", "--seeds", 4, "--out", tmp_path / "out"), "--seeds", "5")
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_written_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "taken").write_text("in the way")
    assert_names(
        refusal(capsys, "train", "cascade", "--out", tmp_path / "taken" / "out"), "taken", "cannot write here"
    )


def test_most_people_come_through() -> None:
    rng = np.random.default_rng(0)
    people, others = (rng.normal(size=(200, CELLS)).astype(np.float16) for _ in range(2))
    people[:, :50] += 1
    trees = fit_cascade(people, others, patch_pool(50), Boosting(20, 0.3))
    running = trees.running(integrate_windows(people))
    assert (running >= trees.least).all(axis=1).mean() > 0.8
    assert np.isfinite(trees.least).all()


@pytest.mark.slow
def test_trees_learn_where_in_their_windows_people_are() -> None:
    rng = np.random.default_rng(0)
    seen = rng.normal(size=(200, CELLS)).astype(np.float16)
    is_so = seen[:, [5, 400, 900, 1700]] > 0
    told = np.where(is_so, [0.1, 0.05, 0.1, 0.5], [-0.1, -0.05, -0.1, 0.3])
    # Little else, or of the features that are drawn few would be of use.
    seen[:] = np.repeat(is_so, CELLS // 4, axis=1) + 0.01 * seen
    placing = fit_boxes(seen, told, patch_pool(0))
    none, window = np.zeros(1, np.int64), np.array([[100.0, 50.0, 16.0, 40.0]])
    found = np.concatenate(
        [
            encode_boxes(window, placing.boxes(integrate(cells), none, none, window))
            for cells in seen.astype(np.float32).reshape(-1, CHANNELS, ROWS, COLUMNS)
        ]
    )
    np.testing.assert_allclose(found, told, atol=0.03)


def test_too_few_windows_are_refused() -> None:
    few, many = np.zeros((3, CELLS), np.float16), np.zeros((50, CELLS), np.float16)
    with refused("3 windows with people", "use more sequences"):
        fit_cascade(few, many, patch_pool(0), Boosting(2, 0.3))
