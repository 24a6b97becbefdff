from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.studies.people_learning.people_film_task import PeopleFilmTask
from peopleboy.scenarios.studies.people_learning.worlds_to_learn_from import KINDS, LATER, world_of
from peopleboy.scenarios.studies.second_look import network_lesson, teach_network
from peopleboy.scenarios.studies.second_look.looks import LookExamples
from peopleboy.scenarios.studies.second_look.network_lesson import (
    later_seeds,
    overlap_of,
    refuse_one_kind,
    with_log_odds,
)
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.proposals.crops import COLUMNS, NUMBERS, PLANES, ROWS, SCORES, planes_of
from peopleboy.tracker.proposals.placing import moved
from peopleboy.tracker.proposals.second_look import SecondLook
from tests.helpers.calls.command_line import run_cli
from tests.helpers.calls.refused import refused
from tests.helpers.images.drawn_films import drawn_film


def test_the_lesson_leaves_a_network_that_says_how_good_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(PeopleFilmTask, "__call__", lambda task, _: drawn_film(task.seed, 3).save(task.film))
    monkeypatch.setattr(network_lesson, "ROUNDS", 1)
    monkeypatch.setattr(teach_network, "_BATCH", 8)
    chosen = ("--worlds", 10, "--second-look", "--out", tmp_path, "--workers", 1)
    assert run_cli("train-detector", *chosen) == 0
    about = SecondLook.load(tmp_path / "second_look.npz").about
    assert about["learned from"].startswith("9 films, ")
    assert "log loss" in about["on 1 others"]


def test_trees_are_not_asked_for_beside_the_second_look(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for asked in (("--only-places",), ("--windows", "cut")):
        assert run_cli("train-detector", "--second-look", *asked, "--out", tmp_path / "out") == 2
        assert "--second-look teaches no trees" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_later_worlds_are_of_the_same_kinds_and_no_trees_were_taught_on_them() -> None:
    seeds = later_seeds(2000)
    assert len(seeds) == len(set(seeds)) == 2000
    taught = {seed for kind in KINDS for seed in kind.seeds(1500)}
    assert not taught & set(seeds)
    crowd = KINDS[1]
    assert world_of(LATER + crowd.first_seed) == crowd.draw(LATER + crowd.first_seed)


def test_without_jax_the_lesson_says_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "optax", None)
    monkeypatch.delitem(sys.modules, teach_network.__name__)
    assert run_cli("train-detector", "--second-look", "--out", tmp_path / "out") == 2
    assert "pip install jax optax" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_overlap_of_offsets_is_that_of_the_boxes() -> None:
    rng = np.random.default_rng(0)
    told, true = (rng.normal(0.0, 0.03, (20, 4)) + np.array([0.0, 0.0, 0.0, 0.22]) for _ in range(2))
    window = np.tile([40.0, 50.0, 30.0, 80.0], (20, 1))
    expected = iou(moved(window, told), moved(window, true))
    np.testing.assert_allclose(overlap_of(told, true), expected, rtol=1e-6)


@pytest.mark.parametrize(
    ("overlap", "told"), [([0.9, 0.8, 0.3], "2 of 2"), ([0.0, 0.1], "0 of 2"), ([], "0 of 0")]
)
def test_people_alone_or_none_are_refused(overlap: list[float], told: str) -> None:
    none = LookExamples.joined([])
    with refused(f"{told} proposals held back are people", "take more worlds"):
        refuse_one_kind(none._replace(overlap=np.array(overlap, np.float32)))


def test_scores_become_log_odds() -> None:
    # A network that says nothing new, of a first look that is four times too sure.
    rng = np.random.default_rng(0)
    true = rng.normal(0.0, 1.5, 4000)
    is_person = rng.random(4000) < 1.0 / (1.0 + np.exp(-true))
    numbers = np.zeros((4000, NUMBERS), np.float32)
    numbers[:, 0] = 4.0 * true / SCORES
    crops = np.broadcast_to(np.uint8(0), (4000, ROWS, COLUMNS, PLANES))
    looks = LookExamples(crops, numbers, is_person.astype(np.float32), np.zeros((4000, 4), np.float32))
    weights = teach_network.first_weights(rng)
    weights["last"][:] = 0.0
    network = with_log_odds(replace(SecondLook(weights)), looks)
    gain, offset = network.weights["line"].tolist()
    assert gain == pytest.approx(0.25, abs=0.03)
    assert offset == pytest.approx(0.0, abs=0.1)
    told = network.told(planes_of(crops[:5]), numbers[:5])[:, 0]
    np.testing.assert_allclose(told, gain * 4.0 * true[:5] + offset, rtol=1e-4, atol=1e-4)
