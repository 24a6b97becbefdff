"""Train the rescoring network on detections of the shipped cascade."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Final

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.detector.crop_samples import (
    CropData,
    CropSamples,
    CropTraining,
    Version,
    mean_overlaps,
    predictions,
)
from peopleboy.studies.training.detector.evaluation import check_labels, log_odds_line
from peopleboy.studies.training.optimiser import huber
from peopleboy.tracker.boxes import Floats, iou
from peopleboy.tracker.networks.inference import CropNetwork
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.detector.box_regression import OFFSETS, encode_boxes
from peopleboy.tracker.sensors.thermal.detector.crops import SCORES
from peopleboy.tracker.sensors.thermal.detector.detector import SMALLEST_PX, WEAKEST, detect_with_trees
from peopleboy.tracker.sensors.thermal.detector.people_trees import shipped_people_trees
from peopleboy.tracker.sensors.thermal.detector.rescoring import RescoringNetwork

POSITIVE: Final = 0.35
"""IoU from which on a detection is a positive."""
NEGATIVE: Final = 0.2
"""IoU up to which a detection is a negative; detections in between are ignored."""

_JITTERED: Final = 0.5  # share of detections that are added a second time, displaced
_ASIDE: Final = (0.04, 0.05)  # standard deviations of the displacement to the right and down, in heights
_GROWN: Final = 0.09  # standard deviation of the logarithm of the size
_SCORE: Final = 0.5  # standard deviation of the score
_OFFSETS: Final = 0.5  # weight of the offsets in the loss
_LINEAR_FROM: Final = 2.0  # error of an offset in units, from which on its loss is linear


@dataclass(frozen=True, slots=True, kw_only=True)
class RescoringTraining(CropTraining):
    """The training data are the shipped cascade's detections in random worlds that are new to it."""

    NETWORK: ClassVar[type[RescoringNetwork]] = RescoringNetwork
    DROPOUT: ClassVar[float] = 0.4
    VERSIONS: ClassVar[int] = 2

    def sample(self, version: Version, *, augments: bool) -> CropSamples:
        """Collect the cascade's detections in an image, and displaced copies of some of them."""
        image, mount, rng = version
        trees = shipped_people_trees()
        found = detect_with_trees(trees, image.grey, image.change, mount, SMALLEST_PX, WEAKEST)
        found = _jitter(found, rng) if augments else found
        return CropSamples.cut(version, found, *_match(found.box, image.box), self.NETWORK.ARCHITECTURE.crop)

    def check(self, others: CropSamples) -> None:
        """Check that the samples are sufficient for calibrating scores."""
        check_labels(_labelled(np.zeros(len(others.overlap)), others)[1])

    def loss(self, outputs: jax.Array, batch: CropSamples) -> tuple[jax.Array, dict[str, jax.Array]]:
        """Return the losses of log odds, and of offsets in units."""
        score = outputs[:, 0] + SCORES * batch.features[:, 0]
        is_person = batch.overlap >= POSITIVE
        counts = is_person | (batch.overlap < NEGATIVE)
        entropy = jnp.logaddexp(0.0, jnp.where(is_person, -score, score)) * counts
        units = (batch.offsets - self.NETWORK.USUAL[1:]) / self.NETWORK.SCALES[1:]
        off = jnp.abs(outputs[:, 1:] - units) * is_person[:, None]
        results = {
            "log loss": entropy.sum() / jnp.maximum(counts.sum(), 1),
            "units off": off.sum() / jnp.maximum(is_person.sum(), 1) / OFFSETS,
        }
        return entropy.mean() + _OFFSETS * huber(off, _LINEAR_FROM).mean(), results

    def fit(self, data: CropData) -> Mapping[str, CropNetwork]:
        """Train the network, and calibrate its scores."""
        others = data.samples.validation
        return {
            file: with_log_odds(network, others) for file, network in CropTraining.fit(self, data).items()
        }

    def evaluate(self, model: RescoringNetwork, data: CropData) -> Mapping[str, str]:
        """Measure how much better scores and boxes are than the cascade's."""
        others = data.samples.validation
        predicted = predictions(model, others)
        first, is_person = _labelled(SCORES * others.features[:, 0].astype(np.float64), others)
        second, _ = _labelled(predicted[:, 0], others)
        losses = [np.logaddexp(0.0, np.where(is_person, -s, s)).mean() for s in (first, second)]
        before, after = mean_overlaps(predicted[:, 1:], others, others.overlap >= POSITIVE)
        result = (
            f"{len(first)} detections, {is_person.sum()} of people: log loss {losses[0]:.3f} of the cascade, "
            f"{losses[1]:.3f} rescored; mean IoU {before:.3f}, {after:.3f}"
        )
        return {f"on {len(data.tasks.validation)} other sequences": result}


def _jitter(found: Detections, rng: np.random.Generator) -> Detections:
    again = np.flatnonzero(rng.random(len(found.box)) < _JITTERED)
    left, top, width, height = found.box[again].T
    right, down = (height * rng.normal(0.0, deviation, len(again)) for deviation in _ASIDE)
    grown = np.exp(rng.normal(0.0, _GROWN, len(again)))
    wide, tall = grown * width, grown * height
    middle, centre = left + width / 2.0 + right, top + height / 2.0 + down
    box = np.stack([middle - wide / 2.0, centre - tall / 2.0, wide, tall], axis=1)
    score = found.score[again] + rng.normal(0.0, _SCORE, len(again))
    return Detections.from_trees(np.concatenate([found.box, box]), np.concatenate([found.score, score]))


def _match(box: Floats, people: Floats) -> tuple[Floats, Floats]:
    """Return the largest IoU of each box (N, 4) with people (P, 4), and the offsets (N, 4) to that person."""
    overlap, offset = np.zeros(len(box)), np.zeros((len(box), OFFSETS))
    if len(people) and len(box):
        shared = iou(box[:, None], people[None])
        overlap = shared.max(axis=1)
        is_some = overlap > 0.0
        offset[is_some] = encode_boxes(box[is_some], people[shared.argmax(axis=1)[is_some]])
    return overlap, offset


def with_log_odds(network: CropNetwork, others: CropSamples) -> RescoringNetwork:
    """Calibrate a network so that its scores are log odds on validation samples.

    Raises:
        BadInput: scikit-learn is missing, or all samples have the same label.
    """
    weights = {**network.weights, "line": np.array([1.0, 0.0], np.float32)}
    score, is_person = _labelled(predictions(RescoringNetwork(weights), others)[:, 0], others)
    weights["line"] = np.array(log_odds_line(score, is_person), np.float32)
    return RescoringNetwork(weights, network.about)


def _labelled(score: Floats, samples: CropSamples) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the scores (M,) of positives and negatives, and their labels."""
    is_person = samples.overlap >= POSITIVE
    counts = is_person | (samples.overlap < NEGATIVE)
    return score[counts], is_person[counts]
