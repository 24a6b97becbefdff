"""Films, windows and trees on images with drawn people, bright columns before speckled ground."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.scenarios.studies.people_learning import people_lesson, teach_cascade, window_mining
from peopleboy.scenarios.studies.people_learning.judge_detector import Found, judge_detector
from peopleboy.scenarios.studies.people_learning.people_film import PeopleFilm, film_upright
from peopleboy.scenarios.studies.people_learning.people_film_task import PeopleFilmTask
from peopleboy.scenarios.studies.people_learning.shots import PeopleShot, shots_of
from peopleboy.tracker.proposals.cascade import FEATURES, Cascade
from peopleboy.tracker.proposals.window import WIDTH_PER_HEIGHT
from peopleboy.tracker.thermal.mount import Mount
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names, refused

ROWS, COLUMNS = 120, 160
FEW = (teach_cascade.Boosting(6, 0.5), teach_cascade.Boosting(8, 0.5))


def drawn_film(seed: int, images: int = 6) -> PeopleFilm:
    """One person an image, upright, of 30 to 60 px; a head, a trunk and two legs that move."""
    rng = np.random.default_rng(seed)
    greys, changes, boxes = [], [], []
    for _ in range(images):
        grey = np.kron(rng.normal(90.0, 12.0, (ROWS // 4, COLUMNS // 4)), np.ones((4, 4)))
        change = np.abs(rng.normal(0.0, 1.0, (ROWS, COLUMNS)))
        tall = float(rng.uniform(30.0, 60.0))
        left, top = float(rng.uniform(20.0, 110.0)), float(rng.uniform(5.0, 55.0))
        wide = 0.3 * tall
        for shown, begin, end in ((0.5, 0.0, 0.15), (1.0, 0.18, 0.55), (0.35, 0.55, 1.0)):
            middle = left + wide / 2.0
            for side in (-1, 1) if end == 1.0 else (0,):
                a = round(middle + side * 0.3 * wide - shown * wide / 2.0)
                where = np.s_[
                    round(top + begin * tall) : round(top + end * tall), a : a + round(shown * wide)
                ]
                grey[where] = 180.0 + rng.normal(0.0, 4.0)
                change[where] += 30.0 * (end == 1.0)
        greys.append(np.clip(grey + rng.normal(0.0, 1.0, grey.shape), 0.0, 255.0).astype(np.uint8))
        changes.append(np.clip(change, 0.0, 255.0).astype(np.uint8))
        boxes.append((left, top, wide, tall))
    return PeopleFilm(
        grey=np.array(greys),
        change=np.array(changes),
        mount=np.array([59.5, 150.0, 1.2]),
        image=np.arange(images),
        box=np.array(boxes),
        visible=np.ones(images),
        inside=np.ones(images),
        shown_px=np.full(images, 200.0),
        is_upright=np.ones(images, np.bool_),
    )


@pytest.fixture(scope="module")
def films(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("films")
    for seed in range(8):
        drawn_film(seed).save(folder / f"{seed}.npz")
    return sorted(folder.iterdir())


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """A lesson on drawn films, of few trees."""
    monkeypatch.setattr(people_lesson, "ROUNDS", FEW)
    monkeypatch.setattr(people_lesson, "TESTS", 2)
    monkeypatch.setattr(PeopleFilmTask, "__call__", lambda task, _: drawn_film(task.seed).save(task.film))


def shot(film: PeopleFilm, path: Path) -> PeopleShot:
    film.save(path)
    return next(shots_of([path]))


def test_a_film_of_a_random_world_tells_who_is_where(tmp_path: Path) -> None:
    film = film_upright(random_scenario(3, 2.5), 3)
    assert film.grey.shape == film.change.shape
    assert 2 <= len(film.grey) <= 3
    assert film.box.shape == (len(film.image), 4)
    assert set(film.image.tolist()) <= set(range(len(film.grey)))
    film.save(tmp_path / "film.npz")
    read = PeopleFilm.load(tmp_path / "film.npz")
    for name in film.__dataclass_fields__:
        np.testing.assert_array_equal(getattr(read, name), getattr(film, name))
    assert isinstance(read.seen_by(), Mount)


def test_boxes_to_learn_from_are_as_wide_as_windows_have_it(films: list[Path]) -> None:
    for one, box in zip(shots_of(films[:1]), drawn_film(0).box, strict=True):
        np.testing.assert_allclose(one.box[0, 2], WIDTH_PER_HEIGHT * box[3])
        np.testing.assert_allclose(one.box[0, 0] + one.box[0, 2] / 2.0, box[0] + box[2] / 2.0)


def test_a_shot_mirrored_twice_is_itself(films: list[Path]) -> None:
    one = next(shots_of(films))
    again = one.mirrored().mirrored()
    np.testing.assert_array_equal(again.grey, one.grey)
    np.testing.assert_allclose(again.box, one.box)


@pytest.mark.parametrize("lack", ["visible", "inside", "is_upright"])
def test_nobody_is_learned_from_who_is_hidden_cut_off_or_low(lack: str, tmp_path: Path) -> None:
    film = drawn_film(0, 1)
    getattr(film, lack)[:] = 0
    one = shot(film, tmp_path / "film.npz")
    assert len(one.box) == 1
    assert not one.is_good.any()
    assert len(window_mining.windows_with_people([one], np.random.default_rng(0))) == 0


def test_windows_without_people_show_nobody(films: list[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[NDArray[np.float64]] = []
    clear = window_mining._is_clear

    def spy(box: NDArray[np.float64], one: PeopleShot) -> NDArray[np.bool_]:
        seen.append(window_mining.iou(box[:, None], one.box[None])[clear(box, one)].ravel())
        return clear(box, one)

    monkeypatch.setattr(window_mining, "_is_clear", spy)
    found = window_mining.windows_anywhere(list(shots_of(films[:2])), np.random.default_rng(0))
    assert found.shape == (len(found), FEATURES)
    assert len(found) > 50
    assert max(one.max(initial=0.0) for one in seen) < 0.3


def test_the_table_says_what_scikit_learn_says() -> None:
    from sklearn.ensemble import GradientBoostingClassifier

    rng = np.random.default_rng(0)
    windows = rng.normal(size=(300, FEATURES)).astype(np.float32)
    is_person = windows[:, 3] + windows[:, 700] * windows[:, 800] > 0.3
    trees = GradientBoostingClassifier(
        n_estimators=12, learning_rate=0.3, max_depth=3, min_samples_leaf=40, random_state=0
    ).fit(windows, is_person)
    table = teach_cascade.as_table([tree.tree_ for tree in trees.estimators_[:, 0]], 0.3)
    prior = np.log(is_person.mean() / (1.0 - is_person.mean()))
    expected = trees.decision_function(windows)
    np.testing.assert_allclose(table.running(windows)[:, -1] + prior, expected, atol=1e-4)


def test_most_people_come_through() -> None:
    rng = np.random.default_rng(0)
    people, others = (rng.normal(size=(200, FEATURES)).astype(np.float16) for _ in range(2))
    people[:, :50] += 1
    cascade = teach_cascade.teach_cascade(people, others, teach_cascade.Boosting(20, 0.3))
    running = cascade.running(people.astype(np.float32))
    came = (running >= cascade.least).all(axis=1)
    assert came.mean() > 0.8
    assert np.isfinite(cascade.least).all()


def test_too_few_windows_are_refused() -> None:
    few, many = np.zeros((3, FEATURES), np.float16), np.zeros((50, FEATURES), np.float16)
    with refused("3 windows with people", "take more worlds"):
        teach_cascade.teach_cascade(few, many, teach_cascade.Boosting(2, 0.3))


@pytest.mark.usefixtures("quick")
def test_drawn_people_are_learned_and_found_in_other_images(films: list[Path]) -> None:
    cascade = people_lesson.teach(list(shots_of(films[:6])), np.random.default_rng(0))
    found = judge_detector(cascade, shots_of(films[6:]), knows_mount=False)
    assert (found.people, found.images) == (12, 12)
    assert found.recall(1.0) > 0.7


def test_figures_of_what_was_found() -> None:
    found = Found(
        score=np.array([3.0, 2.0, 1.0, 0.0]),
        is_person=np.array([True, False, True, False]),
        overlap=np.array([0.8, 0.0, 0.6, 0.0]),
        people=4,
        images=10,
    )
    assert found.recall(0.0) == 0.25
    assert found.recall(0.1) == 0.5
    assert found.precision() == pytest.approx((1.0 + 2.0 / 3.0) / 4.0)
    assert "mean overlap 0.700" in found.in_words()


@pytest.mark.usefixtures("quick")
def test_the_lesson_leaves_films_and_trees_and_says_how_good_they_are(tmp_path: Path) -> None:
    assert run_cli("train-detector", "--worlds", 4, "--out", tmp_path, "--workers", 1) == 0
    names = {path.name for path in (tmp_path / "films").iterdir()}
    assert names == {f"world_{seed}.npz" for seed in (0, 1, 1000, 1001, 1002, 1003)}
    about = Cascade.load(tmp_path / "people.npz").about
    assert about["trained on"] == "4 random worlds, seeds from 1000"
    assert "average precision" in about["on worlds 0 to 1, mount known"]


def test_without_what_teaches_it_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sklearn.ensemble", None)
    windows = np.zeros((30, FEATURES), np.float16)
    with refused("scikit-learn", "peopleboy[train]"):
        teach_cascade.teach_cascade(windows, windows, teach_cascade.Boosting(2, 0.3))


def test_a_folder_that_cannot_be_written_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "taken").write_text("in the way")
    assert_names(
        refusal(capsys, "train-detector", "--out", tmp_path / "taken" / "out"), "taken", "cannot write here"
    )
