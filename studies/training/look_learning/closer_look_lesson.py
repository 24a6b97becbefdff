"""The whole lesson of the closer look: films, people in them, a network, and how well it places them."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.training.look_learning.closer_look_examples import closer_looks_of
from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.studies.training.look_learning.films_of_later_worlds import films_in
from peopleboy.studies.training.look_learning.learned_network import (
    mean_overlaps,
    say,
    told_of,
    write_network,
)
from peopleboy.studies.training.people_learning.people_film_task import PeopleFilmTask
from peopleboy.studies.training.people_learning.shots import shots_of
from peopleboy.tracker.proposals.looks.closer_look import NETWORK, CloserLook

ROUNDS: Final = 2


def give_closer_look_lesson(out: Path, workers: Workers, *, worlds: int, ship: bool) -> Path:
    """Learn where exactly those are who were found, and leave films and a network in a folder.

    Args:
        out: the folder.
        workers: who films.
        worlds: how many to learn from; a tenth is held back, to tell how good the network is.
        ship: whether to put the network in the place of the tracker's own.

    Returns:
        The file of the network.

    Raises:
        BadInput: a path that cannot be used, JAX or Optax is missing, or too few people.
        TasksFailed: some films failed, after all others were done.
    """
    # Here, as they need JAX.
    from peopleboy.studies.training.look_learning.closer_look_loss import CLOSER_LOOK
    from peopleboy.studies.training.look_learning.teach_network import teach_network

    films = films_in(out, workers, worlds)
    learned, others = taken(films.learned, varies=True), taken(films.held, varies=False)
    say(
        f"{len(films.learned)} films, {len(learned.overlap)} boxes to learn from, "
        f"{len(others.overlap)} others"
    )
    if not len(others.overlap):
        raise BadInput(f"nobody is seen in the {len(films.held)} films held back; take more worlds")
    weights = teach_network(CLOSER_LOOK, learned, np.random.default_rng(0), rounds=ROUNDS, say=say)
    about = {
        "learned from": f"{len(films.learned)} films, {len(learned.overlap)} boxes",
        f"on {len(films.held)} others": judged(CloserLook(weights), others),
    }
    return write_network(CloserLook(weights, about), NETWORK if ship else out / NETWORK.name)


def taken(tasks: list[PeopleFilmTask], *, varies: bool) -> LookExamples:
    """Collect boxes about people in films; the seed of each draws how its images are varied."""
    return LookExamples.joined(
        (
            closer_looks_of(list(shots_of([task.film])), np.random.default_rng(task.seed), varies=varies)
            for task in tasks
        ),
        CloserLook.FORM.crop,
    )


def judged(network: CloserLook, looks: LookExamples) -> str:
    """Say in words how much nearer to people boxes are than they were."""
    before, after = mean_overlaps(told_of(network, looks), looks, np.ones(len(looks.overlap), np.bool_))
    return f"{len(looks.overlap)} boxes: mean overlap {before:.3f} before, {after:.3f} then"
