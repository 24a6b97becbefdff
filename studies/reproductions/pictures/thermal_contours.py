"""How well contours fit, with and without people: figures 4.4 and 7.2 of the thesis on people tracking."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.random_streams import stream
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.studies.reproductions.pictures.png import canvas, label
from peopleboy.tracker.frame import THERMAL as CAMERA
from peopleboy.tracker.thermal.contour.likelihood import ContourModel
from peopleboy.tracker.thermal.particles import CROWN, FOOT, H, Y, draw_around, draw_prior
from peopleboy.tracker.thermal.variants import THESIS

SCENE: Final = "passers_by"
SEED: Final = 100
_EVERY: Final = 5  # images from one that is looked at to the next
_FRAMES: Final = 30  # of each kind, as in the thesis
_PLAIN: Final = 0.9  # visible fraction from which a person is seen whole
_THRESHOLD_GREY: Final = 22.0  # theta
_SOURCE, _OURS = "#1a1a1a", "#d95f02"


@dataclass(frozen=True, slots=True, eq=False)
class ThermalMoment:
    """A thermal image (H, W), and who is in it."""

    image: NDArray[np.uint8]
    people: Sequence[PersonTruth]


def thermal_moments() -> Iterator[ThermalMoment]:
    """Play the film, and give every fifth image."""
    for number, (world, seen) in enumerate(blind_drive(load_scenario(SCENE), SEED)):
        if number % _EVERY == 0:
            people = [one for one in world.truth(CAMERA).people if one.visible_px > 0]
            yield ThermalMoment(np.asarray(seen.images[CAMERA], np.uint8), people)


def draw_fitness() -> Figure:
    """Draw how many samples of the prior fit how well, without and with a person: figure 4.4."""
    moments = list(thermal_moments())
    kinds = {
        "30 images without a person": [one for one in moments if not one.people],
        "30 images with a person": [one for one in moments if _whole(one)],
    }
    page, rng = canvas(2.6), stream(SEED, "reproduce.fitness")
    left, right = page.subplots(1, 2, sharey=True)
    for axes, (title, found) in zip((left, right), kinds.items(), strict=True):
        prior = (THESIS.detector.count, found[0].image.shape, THESIS.motion, THESIS.detector)
        fits = [fitness_grey(one.image, draw_prior(*prior, rng)) for one in found[:_FRAMES]]
        axes.hist(np.concatenate(fits), bins=np.arange(-42, 43, 2).tolist(), log=True, color=_OURS)
        axes.axvline(_THRESHOLD_GREY, color=_SOURCE, linestyle="--", linewidth=1)
        label(axes, title, "fitness [grey]; dashed: the threshold", "samples")
    return page


def draw_cues() -> Figure:
    """Draw strength, top and bottom of contours over the distance of their people: figure 7.2."""
    rows = [row for moment in thermal_moments() for row in _cues(moment)]
    distance, *cues = np.array(rows).T
    page = canvas(2.6)
    names = ("strength [grey]", "top [row]", "bottom [row]")
    for axes, values, name in zip(page.subplots(1, 3), cues, names, strict=True):
        axes.plot(distance, values, ".", color=_OURS, markersize=3)
        label(axes, name, "distance [m]")
        if name.endswith("[row]"):
            axes.invert_yaxis()
    return page


def fitness_grey(thermal: NDArray[np.uint8], state: NDArray[np.float32]) -> NDArray[np.float64]:
    """Give the fitness (N,) of samples (N, 9) in grey: equation 4.3, with the literal tracker's cap."""
    height, width = thermal.shape
    model = ContourModel.build((height, width), THESIS.contour)
    differences = model.differences(model.prepare(thermal), state).astype(np.float64)
    fit: NDArray[np.float64] = differences @ model.weights * THESIS.contour.saturation_grey
    return fit


def _cues(moment: ThermalMoment) -> Iterator[tuple[float, float, float, float]]:
    """Give distance, strength, top and bottom of the contour that fits best around each whole person."""
    rng = stream(SEED, "reproduce.cues")
    for person in _whole(moment):
        assert person.box is not None
        state = draw_around(person.box, THESIS, rng)
        fit = fitness_grey(moment.image, state)
        best = state[int(fit.argmax())]
        top, bottom = best[Y] - CROWN * best[H], best[Y] + FOOT * best[H]
        yield person.distance_m, float(fit.max()), float(top), float(bottom)


def _whole(moment: ThermalMoment) -> list[PersonTruth]:
    """List those who are seen whole."""
    return [one for one in moment.people if one.visible_fraction > _PLAIN and one.box is not None]
