from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from peopleboy.studies.training.people_learning import cut_off, people_lesson, teach_placing
from peopleboy.studies.training.people_learning.boosting import Boosting
from peopleboy.studies.training.people_learning.judge_detector import judge_detector
from peopleboy.studies.training.people_learning.patch_pool import patch_pool
from peopleboy.studies.training.people_learning.people_film_task import PeopleFilmTask
from peopleboy.studies.training.people_learning.shots import PeopleShot
from peopleboy.studies.training.people_learning.worlds_to_learn_from import KINDS
from peopleboy.tracker.proposals.model import PeopleModel, shipped_model
from peopleboy.tracker.proposals.patches import Patches
from peopleboy.tracker.proposals.window import Kind
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.images.drawn_films import drawn_film


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """A lesson on drawn films, of few trees."""
    rounds = (Boosting(3, 0.5, features=20), Boosting(4, 0.5, features=20))
    monkeypatch.setattr(people_lesson, "ROUNDS", dict.fromkeys(Kind, rounds))
    monkeypatch.setattr(teach_placing, "_BOOSTING", Boosting(20, 0.3, features=60))
    monkeypatch.setattr(people_lesson, "TESTS", 2)
    monkeypatch.setattr(cut_off, "_TALL_PX", 40.0)
    monkeypatch.setattr(PeopleFilmTask, "__call__", lambda task, _: drawn_film(task.seed, 3).save(task.film))


@pytest.fixture
def few_patches(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = patch_pool()
    some = Patches(whole.channel[::8], whole.first[::8], whole.second[::8])
    monkeypatch.setattr(people_lesson, "patch_pool", lambda: some)


@pytest.mark.slow
@pytest.mark.usefixtures("quick", "few_patches")
def test_drawn_people_are_learned_and_found_in_other_images(shots: list[PeopleShot]) -> None:
    model = PeopleModel(people_lesson.teach(shots[:30], shots[30:36], [Kind.WHOLE]))
    found = judge_detector(model, shots[36:], knows_mount=False)
    assert (found.people, found.images) == (12, 12)
    assert found.recall(1.0) > 0.7
    assert found.overlap[found.is_person].mean() > 0.65


@pytest.mark.slow
@pytest.mark.usefixtures("quick", "few_patches")
def test_the_lesson_leaves_films_and_trees_and_says_how_good_they_are(tmp_path: Path) -> None:
    assert run_cli("train-detector", "--worlds", 5, "--out", tmp_path, "--workers", 1) == 0
    names = {path.name for path in (tmp_path / "films").iterdir()}
    assert names == {f"world_{seed}.npz" for seed in (0, 1, 1000, 1001, 2000, 3000, 3001, 4000, 5000)}
    about = PeopleModel.load(tmp_path / "people.npz").about
    learned_from = (
        "2 random worlds from seed 1000, 1 crowds from seed 2000, 2 worlds in the robot's own span "
        "from seed 3000, 1 plain worlds as warm as people from seed 4000, 1 crowds in the robot's own span "
        "from seed 5000; 1 of them held back"
    )
    assert about["cut people"] == about["whole people"] == learned_from
    assert "average precision" in about["on worlds 0 to 1, mount known"]


@pytest.mark.thorough
@pytest.mark.usefixtures("quick")
def test_trees_that_are_not_taught_stay_as_they_are(tmp_path: Path) -> None:
    chosen = ("--worlds", 5, "--windows", "cut", "--workers", 1)
    assert run_cli("train-detector", *chosen, "--out", tmp_path) == 0
    taught, shipped = PeopleModel.load(tmp_path / "people.npz"), shipped_model()
    before, after = (model.trees[Kind.WHOLE].cascade for model in (shipped, taught))
    np.testing.assert_array_equal(after.leaf, before.leaf, strict=True)
    assert len(taught.trees[Kind.CUT].cascade.leaf) == 4
    assert taught.about["whole people"] == shipped.about["whole people"]
    assert taught.about["cut people"].startswith("2 random worlds")


@pytest.mark.thorough
@pytest.mark.usefixtures("quick")
def test_places_alone_are_taught_for_the_trees_that_are_there(tmp_path: Path) -> None:
    chosen = ("--worlds", 5, "--windows", "whole", "--only-places", "--workers", 1)
    assert run_cli("train-detector", *chosen, "--out", tmp_path) == 0
    taught, shipped = PeopleModel.load(tmp_path / "people.npz"), shipped_model()
    before, after = (model.trees[Kind.WHOLE] for model in (shipped, taught))
    np.testing.assert_array_equal(after.cascade.leaf, before.cascade.leaf, strict=True)
    assert not np.array_equal(after.placing.leaf, before.placing.leaf)
    np.testing.assert_array_equal(taught.trees[Kind.CUT].placing.leaf, shipped.trees[Kind.CUT].placing.leaf)
    assert taught.about["whole people"] == shipped.about["whole people"]
    assert taught.about["where whole people are"].startswith("2 random worlds")


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(("worlds", "held"), [(5, 1), (10, 1), (40, 4)])
def test_a_tenth_of_the_worlds_is_held_back_and_at_least_one(
    worlds: int, held: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    split: list[int] = []

    def stop(shots: list[PeopleShot], others_of: list[PeopleShot], kinds: list[Kind]) -> PeopleModel:
        assert kinds == list(Kind)
        split.extend((len(shots), len(others_of)))
        raise KeyboardInterrupt

    monkeypatch.setattr(PeopleFilmTask, "__call__", lambda task, _: drawn_film(0, 1).save(task.film))
    monkeypatch.setattr(people_lesson, "teach", stop)
    run_cli("train-detector", "--worlds", worlds, "--out", tmp_path, "--workers", 1)
    assert split == [sum(len(kind.seeds(worlds)) for kind in KINDS) - held, held]


def test_too_few_worlds_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert_names(refusal(capsys, "train-detector", "--worlds", 4, "--out", tmp_path / "out"), "--worlds", "5")
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_written_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "taken").write_text("in the way")
    assert_names(
        refusal(capsys, "train-detector", "--out", tmp_path / "taken" / "out"), "taken", "cannot write here"
    )
