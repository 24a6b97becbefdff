from __future__ import annotations

import sys
from pathlib import Path

import pytest

from peopleboy.studies.training.look_learning import closer_look_lesson, teach_network
from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.studies.training.people_learning.people_film_task import PeopleFilmTask
from peopleboy.tracker.proposals.looks.closer_look import CloserLook
from tests.helpers.calls.command_line import run_cli
from tests.helpers.images.drawn_films import drawn_film

LOOKS = ("--second-look", "--closer-look")


@pytest.mark.thorough
@pytest.mark.usefixtures("small")
def test_the_lesson_leaves_a_network_that_says_how_good_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(PeopleFilmTask, "__call__", lambda task, _: drawn_film(task.seed, 3).save(task.film))
    monkeypatch.setattr(closer_look_lesson, "ROUNDS", 1)
    monkeypatch.setattr(teach_network, "_BATCH", 8)
    chosen = ("--worlds", 10, "--closer-look", "--out", tmp_path, "--workers", 1)
    assert run_cli("train-detector", *chosen) == 0
    about = CloserLook.load(tmp_path / "closer_look.npz").about
    assert about["learned from"].startswith("9 films, ")
    assert "mean overlap" in about["on 1 others"]


def test_a_lesson_that_nobody_could_judge_is_refused_before_it_begins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(PeopleFilmTask, "__call__", lambda task, _: drawn_film(task.seed, 3).save(task.film))
    none = LookExamples.joined([], CloserLook.FORM.crop)
    monkeypatch.setattr(closer_look_lesson, "closer_looks_of", lambda *_, **__: none)
    chosen = ("--worlds", 10, "--closer-look", "--out", tmp_path, "--workers", 1)
    assert run_cli("train-detector", *chosen) == 2
    assert "nobody is seen in the 1 films held back; take more worlds" in capsys.readouterr().err
    assert not (tmp_path / "closer_look.npz").exists()


@pytest.mark.parametrize("look", LOOKS)
def test_trees_are_not_asked_for_beside_a_look(
    look: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for asked in (("--only-places",), ("--windows", "cut")):
        assert run_cli("train-detector", look, *asked, "--out", tmp_path / "out") == 2
        assert f"{look} teaches no trees" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_one_look_is_taught_at_a_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli("train-detector", *LOOKS, "--out", tmp_path / "out") == 2
    assert "are two lessons; choose one" in capsys.readouterr().err


@pytest.mark.parametrize("look", LOOKS)
def test_without_jax_the_lesson_says_what_is_missing(
    look: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "optax", None)
    monkeypatch.delitem(sys.modules, teach_network.__name__)
    assert run_cli("train-detector", look, "--out", tmp_path / "out") == 2
    assert "pip install jax optax" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
