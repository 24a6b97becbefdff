"""The whole lesson of the second look: films, what trees propose in them, a network, and how good it is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.studies.training.look_learning.films_of_later_worlds import films_in
from peopleboy.studies.training.look_learning.learned_network import (
    mean_overlaps,
    say,
    told_of,
    write_network,
)
from peopleboy.studies.training.look_learning.second_look_examples import NOBODY, SOMEBODY, looks_of
from peopleboy.studies.training.people_learning.people_film_task import PeopleFilmTask
from peopleboy.studies.training.people_learning.shots import shots_of
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.proposals.looks.crops import SCORES
from peopleboy.tracker.proposals.looks.second_look import NETWORK, SecondLook
from peopleboy.tracker.proposals.model import shipped_model

ROUNDS: Final = 4


def give_second_look_lesson(out: Path, workers: Workers, *, worlds: int, ship: bool) -> Path:
    """Learn to look again at what the tracker's own trees propose, and leave films and a network in a folder.

    Args:
        out: the folder.
        workers: who films.
        worlds: how many to learn from; a tenth is held back, to make scores log odds.
        ship: whether to put the network in the place of the tracker's own.

    Returns:
        The file of the network.

    Raises:
        BadInput: a path that cannot be used, JAX, Optax or scikit-learn is missing, or too few people.
        TasksFailed: some films failed, after all others were done.
    """
    # Here, as they need JAX.
    from peopleboy.studies.training.look_learning.second_look_loss import SECOND_LOOK
    from peopleboy.studies.training.look_learning.teach_network import teach_network

    films = films_in(out, workers, worlds)
    learned, others = taken(films.learned, varies=True), taken(films.held, varies=False)
    say(
        f"{len(films.learned)} films, {len(learned.overlap)} proposals to learn from, "
        f"{len(others.overlap)} others"
    )
    refuse_one_kind(others)
    weights = teach_network(SECOND_LOOK, learned, np.random.default_rng(0), rounds=ROUNDS, say=say)
    network = with_log_odds(SecondLook(weights | {"line": np.array([1.0, 0.0], np.float32)}), others)
    about = {
        "learned from": f"{len(films.learned)} films, {len(learned.overlap)} proposals",
        f"on {len(films.held)} others": judged(network, others),
    }
    return write_network(replace(network, about=about), NETWORK if ship else out / NETWORK.name)


def taken(tasks: list[PeopleFilmTask], *, varies: bool) -> LookExamples:
    """Collect what trees propose in films; the seed of each draws how its images are varied."""
    model = shipped_model()
    return LookExamples.joined(
        (
            looks_of(list(shots_of([task.film])), model, np.random.default_rng(task.seed), varies=varies)
            for task in tasks
        ),
        SecondLook.FORM.crop,
    )


def refuse_one_kind(looks: LookExamples) -> None:
    """Refuse examples by which no scores can be made log odds.

    Raises:
        BadInput: only people or none are proposed.
    """
    _, is_person = _whether(np.zeros(len(looks.overlap)), looks)
    if is_person.all() or not is_person.any():
        raise BadInput(
            f"{is_person.sum()} of {len(is_person)} proposals held back are people; take more worlds"
        )


def with_log_odds(network: SecondLook, looks: LookExamples) -> SecondLook:
    """Let scores be the log odds of somebody among proposals that it never saw (Platt 1999).

    Raises:
        BadInput: scikit-learn is missing, or only people or none are proposed.
    """
    try:
        from sklearn.linear_model import LogisticRegression  # here, as it comes with the extra `train`
    except ImportError as error:
        raise BadInput("train-detector needs scikit-learn: pip install scikit-learn") from error
    refuse_one_kind(looks)
    score, is_person = _whether(told_of(network, looks)[:, 0], looks)
    fitted = LogisticRegression(C=1e6).fit(score[:, None], is_person)
    line = np.array([fitted.coef_[0, 0], fitted.intercept_[0]], np.float32)
    return replace(network, weights={**network.weights, "line": line})


def judged(network: SecondLook, looks: LookExamples) -> str:
    """Say in words how much better the second look tells than the first one."""
    told = told_of(network, looks)
    first, is_person = _whether(SCORES * looks.numbers[:, 0].astype(np.float64), looks)
    second, _ = _whether(told[:, 0], looks)
    losses = [np.logaddexp(0.0, np.where(is_person, -score, score)).mean() for score in (first, second)]
    before, after = mean_overlaps(told[:, 1:], looks, looks.overlap >= SOMEBODY)
    return (
        f"{len(first)} proposals, {is_person.sum()} of people: log loss {losses[0]:.3f} at first sight, "
        f"{losses[1]:.3f} then; mean overlap {before:.3f}, {after:.3f}"
    )


def _whether(score: Floats, looks: LookExamples) -> tuple[Floats, NDArray[np.bool_]]:
    """Give scores (M,) of what is somebody or nobody, and which it is."""
    is_person = looks.overlap >= SOMEBODY
    counts = is_person | (looks.overlap < NOBODY)
    return score[counts], is_person[counts]
