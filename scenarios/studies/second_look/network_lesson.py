"""The whole lesson of the second look: films, what trees propose in them, a network, and how good it is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.out_folder import writing_to
from peopleboy.scenarios.run_folder.whole import whole
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.scenarios.studies.people_learning.people_film_task import PeopleFilmTask
from peopleboy.scenarios.studies.people_learning.shots import shots_of
from peopleboy.scenarios.studies.people_learning.worlds_to_learn_from import KINDS, LATER
from peopleboy.scenarios.studies.second_look.looks import NOBODY, SOMEBODY, LookExamples, looks_of
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.proposals.crops import SCORES, planes_of
from peopleboy.tracker.proposals.model import shipped_model
from peopleboy.tracker.proposals.placing import moved
from peopleboy.tracker.proposals.second_look import NETWORK, SecondLook

ROUNDS: Final = 4
_HELD_BACK: Final = 10  # of so many worlds one is not learned from
_AT_ONCE: Final = 256  # crops


def give_second_look_lesson(out: Path, workers: Workers, *, worlds: int, ship: bool) -> Path:
    """Learn to look again at what the tracker's own trees propose, and leave films and a network in a folder.

    The worlds are later ones than those by which trees are taught, which are surer of what they know. Films
    that are there are used.

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
    from peopleboy.scenarios.studies.second_look.teach_network import teach_network  # here, as it needs JAX

    films = out / "films"
    with writing_to(out):
        films.mkdir(parents=True, exist_ok=True)
    tasks = [PeopleFilmTask(str(films), seed) for seed in later_seeds(worlds)]
    work_through([task for task in tasks if not task.film.is_file()], workers, "films")
    held = [task for task in tasks if task.seed % _HELD_BACK == _HELD_BACK - 1] or tasks[-1:]
    lessons = [task for task in tasks if task not in held]
    learned, others = taken(lessons, varies=True), taken(held, varies=False)
    _say(
        f"{len(lessons)} films, {len(learned.overlap)} proposals to learn from, {len(others.overlap)} others"
    )
    refuse_one_kind(others)
    network = with_log_odds(teach_network(learned, np.random.default_rng(0), rounds=ROUNDS, say=_say), others)
    about = {
        "learned from": f"{len(lessons)} films, {len(learned.overlap)} proposals",
        f"on {len(held)} others": judged(network, others),
    }
    path = NETWORK if ship else out / NETWORK.name
    with writing_to(path.parent), whole(path) as part:
        path.parent.mkdir(parents=True, exist_ok=True)
        replace(network, about=about).save(part)
    return path


def later_seeds(worlds: int) -> list[int]:
    """Give the seeds of so many worlds by which no trees are taught."""
    return [seed + LATER for kind in KINDS for seed in kind.seeds(worlds)]


def taken(tasks: list[PeopleFilmTask], *, varies: bool) -> LookExamples:
    """Collect what trees propose in films; the seed of each draws how its images are varied."""
    model = shipped_model()
    return LookExamples.joined(
        looks_of(list(shots_of([task.film])), model, np.random.default_rng(task.seed), varies=varies)
        for task in tasks
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
    score, is_person = _whether(_told(network, looks)[:, 0], looks)
    fitted = LogisticRegression(C=1e6).fit(score[:, None], is_person)
    line = np.array([fitted.coef_[0, 0], fitted.intercept_[0]], np.float32)
    return replace(network, weights={**network.weights, "line": line})


def judged(network: SecondLook, looks: LookExamples) -> str:
    """Say in words how much better the second look tells than the first one."""
    told = _told(network, looks)
    first, is_person = _whether(SCORES * looks.numbers[:, 0].astype(np.float64), looks)
    second, _ = _whether(told[:, 0], looks)
    losses = [np.logaddexp(0.0, np.where(is_person, -score, score)).mean() for score in (first, second)]
    people = looks.overlap >= SOMEBODY
    before, after = (
        looks.overlap[people],
        overlap_of(told[people, 1:], looks.offsets[people].astype(np.float64)),
    )
    return (
        f"{len(first)} proposals, {is_person.sum()} of people: log loss {losses[0]:.3f} at first sight, "
        f"{losses[1]:.3f} then; mean overlap {before.mean():.3f}, {after.mean():.3f}"
    )


def overlap_of(told: Floats, true: Floats) -> Floats:
    """Give the IoU (N,) of boxes by their offsets (N, 4) from the same windows."""
    window = np.tile([0.0, 0.0, 1.0, 1.0], (len(told), 1))
    one, other = moved(window, told), moved(window, true)
    low, high = (
        np.maximum(one[:, :2], other[:, :2]),
        np.minimum(one[:, :2] + one[:, 2:], other[:, :2] + other[:, 2:]),
    )
    common = np.prod(np.maximum(high - low, 0.0), axis=1)
    return np.asarray(common / (np.prod(one[:, 2:], axis=1) + np.prod(other[:, 2:], axis=1) - common))


def _whether(score: Floats, looks: LookExamples) -> tuple[Floats, NDArray[np.bool_]]:
    """Give scores (M,) of what is somebody or nobody, and which it is."""
    is_person = looks.overlap >= SOMEBODY
    counts = is_person | (looks.overlap < NOBODY)
    return score[counts], is_person[counts]


def _told(network: SecondLook, looks: LookExamples) -> Floats:
    parts = [
        np.arange(k, min(k + _AT_ONCE, len(looks.overlap))) for k in range(0, len(looks.overlap), _AT_ONCE)
    ]
    told = [network.told(planes_of(looks.crops[part]), looks.numbers[part]) for part in parts]
    return np.concatenate([np.empty((0, 1 + looks.offsets.shape[1])), *told])


def _say(words: str) -> None:
    Console(stderr=True).print(words, highlight=False)
