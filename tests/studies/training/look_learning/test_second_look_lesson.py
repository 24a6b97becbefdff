from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from peopleboy.studies.training.look_learning import second_look_lesson, teach_network
from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.studies.training.look_learning.second_look_lesson import refuse_one_kind, with_log_odds
from peopleboy.studies.training.people_learning.people_film_task import PeopleFilmTask
from peopleboy.tracker.proposals.looks.crops import NUMBERS, PLANES, SCORES, planes_of
from peopleboy.tracker.proposals.looks.second_look import SecondLook
from tests.helpers.calls.command_line import run_cli
from tests.helpers.calls.refused import refused
from tests.helpers.images.drawn_films import drawn_film


@pytest.mark.thorough
@pytest.mark.usefixtures("small")
def test_the_lesson_leaves_a_network_that_says_how_good_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(PeopleFilmTask, "__call__", lambda task, _: drawn_film(task.seed, 3).save(task.film))
    monkeypatch.setattr(second_look_lesson, "ROUNDS", 1)
    monkeypatch.setattr(teach_network, "_BATCH", 8)
    chosen = ("--worlds", 10, "--second-look", "--out", tmp_path, "--workers", 1)
    assert run_cli("train-detector", *chosen) == 0
    about = SecondLook.load(tmp_path / "second_look.npz").about
    assert about["learned from"].startswith("9 films, ")
    assert "log loss" in about["on 1 others"]


@pytest.mark.parametrize(
    ("overlap", "told"), [([0.9, 0.8, 0.3], "2 of 2"), ([0.0, 0.1], "0 of 2"), ([], "0 of 0")]
)
def test_people_alone_or_none_are_refused(overlap: list[float], told: str) -> None:
    none = LookExamples.joined([], SecondLook.FORM.crop)
    with refused(f"{told} proposals held back are people", "take more worlds"):
        refuse_one_kind(none._replace(overlap=np.array(overlap, np.float32)))


@pytest.mark.usefixtures("small")
def test_scores_become_log_odds() -> None:
    # A network that says nothing new, of a first look that is four times too sure.
    rng = np.random.default_rng(0)
    true = rng.normal(0.0, 1.5, 4000)
    is_person = rng.random(4000) < 1.0 / (1.0 + np.exp(-true))
    numbers = np.zeros((4000, NUMBERS), np.float32)
    numbers[:, 0] = 4.0 * true / SCORES
    crops = np.broadcast_to(np.uint8(0), (4000, *SecondLook.FORM.crop[:2], PLANES))
    looks = LookExamples(crops, numbers, is_person.astype(np.float32), np.zeros((4000, 4), np.float32))
    weights = teach_network.first_weights(SecondLook.FORM, rng)
    weights["last"][:] = 0.0
    network = with_log_odds(SecondLook(weights | {"line": np.array([1.0, 0.0], np.float32)}), looks)
    gain, offset = network.weights["line"].tolist()
    assert gain == pytest.approx(0.25, abs=0.03)
    assert offset == pytest.approx(0.0, abs=0.1)
    told = network.told(planes_of(crops[:5]), numbers[:5])[:, 0]
    np.testing.assert_allclose(told, gain * 4.0 * true[:5] + offset, rtol=1e-4, atol=1e-4)
