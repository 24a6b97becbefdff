"""The whole lesson: film scenes drawn at random, teach a network on them, judge it on others, write it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np
from rich.console import Console

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.run_folder.atomic_output import atomic, writing_to
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.training.foreground_learning.film_task import FilmTask
from peopleboy.studies.training.foreground_learning.judge_masks import Judgement, judge
from peopleboy.studies.training.foreground_learning.masked_film import MaskedFilm
from peopleboy.studies.training.foreground_learning.play_films import collect, study, watch
from peopleboy.studies.training.foreground_learning.teach_network import Adam, first_network
from peopleboy.tracker.frame import PANORAMA, Calibration
from peopleboy.tracker.panoramic.foreground.layers import BLOCK
from peopleboy.tracker.panoramic.foreground.network_file import SHIPPED, ForegroundModel
from peopleboy.tracker.panoramic.panorama_view import PanoramaView, view_of

FIRST_SEED: Final = 100
"""Scenes to learn from have seeds from here on; those to judge by have the first ones."""
_FILMS_A_ROUND = 100  # what is learned from in a round, is in memory: 10 MB a film


@dataclass(frozen=True, slots=True, kw_only=True)
class ForegroundLessons:
    """How the network is taught.

    Attributes:
        scenes: to learn from.
        tests: scenes to judge by.
        rounds: in each, a hundred scenes are played to the network as it is by then, and learned from.
        rates: of learning, at the beginning and at the end; it falls by the same factor in each round.
    """

    scenes: int = 400
    tests: int = 20
    rounds: int = 12
    rates: tuple[float, float] = (4e-3, 1e-4)


def give_foreground_lesson(out: Path, workers: Workers, lessons: ForegroundLessons, *, ship: bool) -> Path:
    """Learn to tell people from background, and leave scenes, films and the network in a folder.

    Films that an earlier lesson left there are used.

    Args:
        out: the folder.
        workers: who films.
        lessons: how the network is taught.
        ship: whether to put the network in the place of the tracker's own.

    Returns:
        The network's file.

    Raises:
        BadInput: a path that cannot be used.
        TasksFailed: some films failed, after all others were done.
    """
    films = out / "films"
    with writing_to(out):
        films.mkdir(parents=True, exist_ok=True)
    tests = [FilmTask(str(films), seed) for seed in range(lessons.tests)]
    tasks = [FilmTask(str(films), seed) for seed in range(FIRST_SEED, FIRST_SEED + lessons.scenes)]
    missing = [task for task in (*tests, *tasks) if not task.film.is_file()]
    work_through(missing, workers, "films")
    calibration = calibrations_of(load_scenario(_scenario(tasks[0])).world(0).robot.cameras)[PANORAMA]
    model = _teach([task.film for task in tasks], calibration, lessons)
    judged = _print_judgements([task.film for task in tests], model, calibration)
    path = SHIPPED if ship else out / SHIPPED.name
    with writing_to(path.parent), atomic(path) as part:
        path.parent.mkdir(parents=True, exist_ok=True)
        ForegroundModel(network=model.network, view=model.view, about=model.about | judged).save(part)
    return path


def _scenario(task: FilmTask) -> Path:
    return task.film.with_suffix(".yaml")


def _teach(films: Sequence[Path], calibration: Calibration, lessons: ForegroundLessons) -> ForegroundModel:
    """Teach a network, and tell of each round how well it went."""
    view, rng = _view(films[0], calibration), np.random.default_rng(0)
    pupil = Adam(network=first_network(view.height_px // BLOCK, rng))
    rates = np.geomspace(*lessons.rates, lessons.rounds + 1).tolist()
    for number, (first, last) in enumerate(pairwise(rates)):
        chosen = [films[k] for k in rng.permutation(len(films))[:_FILMS_A_ROUND]]
        model = ForegroundModel(network=pupil.network, view=view)
        examples = collect(chosen, model, calibration, rng)
        losses = [study(pupil, examples, rng, pair) for pair in ((first, last), (last, last))]
        _say(f"round {number + 1} of {lessons.rounds}: {losses[-1]:.4f} nat a pixel")
    about = {
        "trained on": f"{len(films)} scenes drawn at random, seeds from {FIRST_SEED}",
        "lessons": f"{lessons.rounds} rounds, {pupil.steps} steps",
    }
    return ForegroundModel(network=pupil.network, view=view, about=about)


def _view(film: Path, calibration: Calibration) -> PanoramaView:
    height, width = MaskedFilm.load(film).images.shape[1:3]
    return view_of(calibration, width, height)


def _print_judgements(
    films: Sequence[Path], model: ForegroundModel, calibration: Calibration
) -> dict[str, str]:
    """Judge the network on films that it has not seen, and say in words how well it did."""
    sums = {"a standing robot": Judgement(), "a driving robot": Judgement()}
    for path in films:
        film = MaskedFilm.load(path)
        robot = "a driving robot" if film.is_driven else "a standing robot"
        judge(film, watch(film, model, calibration), sums[robot])
    told = {f"on other scenes, {robot}": judged.in_words() for robot, judged in sums.items() if judged.images}
    for about, words in told.items():
        _say(f"{about}: {words}")
    return told


def _say(words: str) -> None:
    Console(stderr=True).print(words, highlight=False)
