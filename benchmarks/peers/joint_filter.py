"""One joint particle filter for all people, with an interaction term, sampled by MCMC.

Khan, Balch and Dellaert, An MCMC-based particle filter for tracking multiple interacting targets, ECCV 2004:
the joint state has a Markov random field that keeps people apart, and is sampled by Metropolis-Hastings,
moving one person at a time. Contour, likelihood, motion model, detector and track deletion are those of the
literal tracker, so that the two differ only in how they represent several people.
"""

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from benchmarks.peers.detectors import Boxes
from peopleboy.tracker.frame import THERMAL, Frame, time_step
from peopleboy.tracker.reproductions.contour.box_interaction import box_of, detector_factor, regions_of
from peopleboy.tracker.reproductions.contour.measurement.likelihood import ContourModel, fitness, probability
from peopleboy.tracker.reproductions.contour.particle_filter import (
    OUTSIDE_WEIGHT,
    Belief,
    FrameView,
    advance,
    begin,
    is_within,
    view_frame,
    weigh,
)
from peopleboy.tracker.reproductions.contour.particles import (
    Floats,
    equally_weighted,
    mean_state,
    uncertainty_px2,
)
from peopleboy.tracker.reproductions.contour.tracked_person import is_born, is_kept
from peopleboy.tracker.reproductions.contour.variants import THESIS

# Steps of the chain per person. It rejects most proposals: with 1000 steps, the literal tracker's number of
# samples, it finds half as many people.
_STEPS: Final = 4000
_BURN_IN: Final = 0.2  # share of the steps that is discarded


class JointFilter:
    """Tracker that detects people one at a time, and tracks all of them with one chain."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._people: dict[int, Floats] = {}  # samples (N, 9) of each person
        self._detector: Belief | None = None
        self._born = 0
        self._last_s: float | None = None
        self._model: ContourModel | None = None

    def step(self, frame: Frame) -> tuple[Boxes, list[int]]:
        """Update all tracks, search for a new person, and return the boxes."""
        dt_s = time_step(frame.time_s, self._last_s)
        self._last_s = frame.time_s
        if self._model is None:
            height, width = frame.grey(THERMAL).shape
            self._model = ContourModel.build((height, width), THESIS.contour)
        view = view_frame(frame, dt_s, self._model, THESIS)
        beliefs = self._follow(view)
        self._people = {number: belief.particles.state for number, belief in beliefs.items()}
        self._search(view, beliefs)
        boxes = [box_of(belief.estimate, THESIS.box) for belief in beliefs.values()]
        return np.array(boxes).reshape(-1, 4), list(beliefs)

    def _follow(self, view: FrameView) -> dict[int, Belief]:
        """Sample the joint posterior, and delete lost tracks."""
        particles = [self._proposed(state, view) for state in self._people.values()]
        chances = [_likelihood(state, view) for state in particles]
        rectangles = [regions_of(list(state), THESIS).astype(np.float64) for state in particles]
        kept = run_chain(chances, rectangles, THESIS.interaction.penalty, self._rng)
        beliefs = {
            number: _belief(state[rows], chance[rows])
            for number, state, chance, rows in zip(self._people, particles, chances, kept, strict=True)
        }
        return {number: one for number, one in beliefs.items() if is_kept(one, view, THESIS.life)}

    def _proposed(self, state: Floats, view: FrameView) -> Floats:
        """Draw proposals (N, 9), one per step of the chain, from the motion model of a person's samples."""
        person = replace(THESIS.person, count=_STEPS)
        drawn = advance(equally_weighted(state), view, person, THESIS, self._rng)
        # Samples of the prior come last; shuffle, so that the chain meets both kinds equally often.
        return self._rng.permutation(drawn)

    def _search(self, view: FrameView, beliefs: dict[int, Belief]) -> None:
        if self._detector is None:
            self._detector = begin(view, THESIS.detector, THESIS, self._rng)
            return
        state = advance(self._detector.particles, view, THESIS.detector, THESIS, self._rng)
        known = regions_of([belief.estimate for belief in beliefs.values()], THESIS)
        factor = detector_factor(state, known, THESIS)
        self._detector = weigh(state, view, THESIS.detector, THESIS, factor)
        if is_born(self._detector, view, THESIS.life):
            self._born += 1
            particles = self._detector.particles
            rows = self._rng.choice(len(particles), _STEPS, p=particles.weight / particles.weight.sum())
            self._people[self._born] = particles.state[rows]
            self._detector = None


def run_chain(
    chances: list[NDArray[np.float64]],
    rectangles: list[NDArray[np.float64]],
    penalty: float,
    rng: np.random.Generator,
) -> list[NDArray[np.int64]]:
    """Sample the joint states of M people by Metropolis-Hastings.

    Proposals are drawn from the motion model independently of the chain's state, so that their likelihoods
    can be computed in advance; only acceptance depends on the chain.

    Args:
        chances: likelihoods (N,) of each person's proposals.
        rectangles: boxes (N, 4) of the proposals: left, top, width, height [px].
        penalty: potential of the field, by the share of a rectangle inside other people's rectangles.
        rng: random generator.

    Returns:
        Per person the proposals (K,) that the chain visited after its burn-in.

    Source: Khan et al., algorithm 2.
    """
    if not chances:
        return []
    count, people = len(chances[0]), len(chances)
    boxes = [one.tolist() for one in rectangles]
    weights = [one.tolist() for one in chances]
    at = [0] * people
    walked: list[list[int]] = [[] for _ in range(people)]
    who = rng.permutation(np.repeat(np.arange(people), count)).tolist()
    turns = [0] * people
    for draw, person in zip(rng.random(len(who)).tolist(), who, strict=True):
        new, old = turns[person], at[person]
        turns[person] += 1
        others = [boxes[other][at[other]] for other in range(people) if other != person]
        gain = weights[person][new] / max(weights[person][old], 1e-30)
        if others:
            apart = _overlap(boxes[person][old], others) - _overlap(boxes[person][new], others)
            gain *= float(np.exp(penalty * apart))
        if draw < gain:
            at[person] = new
        walked[person].append(at[person])
    start = round(_BURN_IN * count)
    return [np.array(rows[start:], np.int64) for rows in walked]


def _overlap(box: list[float], others: list[list[float]]) -> float:
    """Return the sum of the shares of a box that lie in others."""
    left, top, width, height = box
    total = 0.0
    for x, y, w, h in others:
        wide = min(left + width, x + w) - max(left, x)
        high = min(top + height, y + h) - max(top, y)
        if wide > 0.0 and high > 0.0:
            total += wide * high
    return total / max(width * height, 1e-9)


def _likelihood(state: Floats, view: FrameView) -> NDArray[np.float64]:
    """Return p(Z | X) of samples (N, 9): equation 4.4 of the thesis, and almost 0 outside its limits."""
    differences = view.model.differences(view.image, state, view.covered)
    chance = probability(fitness(differences, view.model.weights, THESIS.likelihood), THESIS.likelihood)
    inside = is_within(state, view.image.shape[0], THESIS.person.limits)
    return np.where(inside, chance, OUTSIDE_WEIGHT * chance).astype(np.float64)


def _belief(state: Floats, chance: NDArray[np.float64]) -> Belief:
    """Return a person's particles from equally weighted samples (K, 9) of the posterior."""
    alike = equally_weighted(state)
    return Belief(alike, alike, mean_state(alike), float(chance.mean()), uncertainty_px2(alike))
