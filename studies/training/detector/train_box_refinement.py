"""Train the box refinement network on people's boxes with the typical errors of rescored boxes.

It also learns the left and right edge of the whole person, arms and legs included.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Final

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.detector.crop_samples import (
    CropData,
    CropSamples,
    CropTraining,
    Version,
    mean_overlaps,
    predictions,
)
from peopleboy.studies.training.detector.world_sequences import ThermalImage
from peopleboy.studies.training.optimiser import huber
from peopleboy.tracker.boxes import area, cover, intersection, iou
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.detector.box_regression import OFFSETS, encode_boxes
from peopleboy.tracker.sensors.thermal.detector.rescoring import EDGES, BoxRefinementNetwork, encode_edges
from peopleboy.tracker.sensors.thermal.detector.window import Floats

_HARDLY_VISIBLE: Final = 0.3  # share of occluded or non-upright people that are sampled
_INSIDE: Final = 0.25  # least share of a box inside the image
_TALL_PX: Final = 16.0
# Errors of rescored boxes: standard deviations of middle, head and feet in heights, and of the logarithm of
# the width.
_MIDDLE, _HEAD, _FEET, _WIDTH = 0.018, 0.03, 0.055, 0.1
_FAR_OFF: Final = 0.3  # share of boxes with larger errors
_FARTHER: Final = 2.2  # factor on their errors
_LOWEST: Final = 0.4  # least height of a box, relative to its person

_OVERLAP: Final = 4.0  # weight of 1 - IoU
_UNITS: Final = 0.3  # weight of the errors in units
_EDGES: Final = 0.6  # weight of the errors of edges in units
_EDGES_VISIBLE: Final = 0.7  # least visible share of a person whose edges are learned
_LINEAR_FROM: Final = 1.0  # error in units, from which on the loss is linear
_MOST: Final = 8.0  # largest loss per offset; a box that is farther off belongs to another person
_CLIPPED: Final = 12.0  # units; boxes without overlap have no gradient of IoU
_NOTHING: Final = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class BoxRefinementTraining(CropTraining):
    """The training data are people in random worlds that are new to the shipped cascade."""

    NETWORK: ClassVar[type[BoxRefinementNetwork]] = BoxRefinementNetwork
    DROPOUT: ClassVar[float] = 0.2
    VERSIONS: ClassVar[int] = 4
    TARGETS: ClassVar[int] = OFFSETS + EDGES

    epochs: Annotated[int, Field(ge=1, description="Number of passes through the samples.")] = 2

    def sample(self, version: Version, *, augments: bool) -> CropSamples:  # noqa: ARG002
        """Collect the people of an image with displaced boxes."""
        image, rows = version.image, _is_sampled(version.image, version.rng)
        people = image.box[rows]
        boxes = _displace(people, version.rng)
        found = Detections.from_trees(boxes, np.zeros(len(boxes)))
        edges = encode_edges(boxes, image.whole[rows])
        edges[image.visible[rows] < _EDGES_VISIBLE] = np.nan
        offsets = np.concatenate([encode_boxes(boxes, people), edges], axis=1)
        return CropSamples.cut(version, found, iou(boxes, people), offsets, self.NETWORK.ARCHITECTURE.crop)

    def check(self, others: CropSamples) -> None:
        """Check that people are visible in the validation sequences."""
        if not len(others):
            raise BadInput("no people are visible in the validation sequences; use more sequences")

    def loss(self, outputs: jax.Array, batch: CropSamples) -> tuple[jax.Array, dict[str, jax.Array]]:
        """Return the losses of overlap (Yu et al., UnitBox 2016), and of offsets and known edges in units."""
        scales, usual = self.NETWORK.SCALES, self.NETWORK.USUAL
        units = (jnp.asarray(batch.offsets) - usual) / scales
        off = jnp.where(jnp.isnan(units), 0.0, jnp.abs(outputs - jnp.nan_to_num(units)))
        offsets = (jnp.clip(outputs, -_CLIPPED, _CLIPPED) * scales + usual)[:, :OFFSETS]
        overlap = _iou(offsets, jnp.asarray(batch.offsets)[:, :OFFSETS])
        losses = jnp.minimum(huber(off, _LINEAR_FROM), _MOST)
        box, edges = losses[:, :OFFSETS].mean(axis=1), losses[:, OFFSETS:].mean(axis=1)
        whole = _OVERLAP * (1.0 - overlap) + _UNITS * box + _EDGES * edges
        return whole.mean(), {"overlap": overlap.mean(), "units off": off.mean()}

    def evaluate(self, model: BoxRefinementNetwork, data: CropData) -> Mapping[str, str]:
        """Measure how much the overlap of boxes with people improves."""
        others = data.samples.validation
        predicted, rows = predictions(model, others), np.ones(len(others), np.bool_)
        before, after = mean_overlaps(predicted, others, rows)
        edges, usual = _edge_overlaps(predicted, others.offsets), _edge_overlaps(model.USUAL, others.offsets)
        result = (
            f"{len(rows)} boxes: mean IoU {before:.3f} before, {after:.3f} refined; "
            f"of the extent from left to right {usual:.3f} at the usual width, {edges:.3f} refined"
        )
        return {f"on {len(data.tasks.validation)} other sequences": result}


def _edge_overlaps(predicted: Floats, offsets: NDArray[np.float32]) -> float:
    """Return the mean overlap of people's extents from left to right with predicted ones, (N, 6) both."""
    known = offsets[~np.isnan(offsets[:, OFFSETS])]
    predicted = np.broadcast_to(predicted, offsets.shape)[~np.isnan(offsets[:, OFFSETS])]
    (a, b), (p, q) = known[:, OFFSETS:].T, predicted[:, OFFSETS:].T
    common = np.maximum(np.minimum(b, q) - np.maximum(a, p), 0.0)
    return float(np.mean(common / (np.maximum(b, q) - np.minimum(a, p))))


def _is_sampled(image: ThermalImage, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Return which people (P,) to sample: those that are visible enough, and a random share of the others."""
    rows, columns = image.grey.shape
    whole = np.array([0.0, 0.0, columns, rows])
    is_inside = cover(intersection(image.box, whole), area(image.box)) > _INSIDE
    is_visible = image.is_good | image.is_clear | (rng.random(len(image.box)) < _HARDLY_VISIBLE)
    return np.asarray(is_visible & is_inside & (image.box[:, 3] > _TALL_PX), np.bool_)


def _displace(people: Floats, rng: np.random.Generator) -> Floats:
    """Displace boxes of people (P, 4) by typical errors of rescored boxes."""
    left, top, width, height = people.T
    far = np.where(rng.random(len(people)) < _FAR_OFF, _FARTHER, 1.0)
    aside, up, down, wider = (
        far * rng.normal(0.0, off, len(people)) for off in (_MIDDLE, _HEAD, _FEET, _WIDTH)
    )
    wide, tall = width * np.exp(wider), height * np.maximum(1.0 + down - up, _LOWEST)
    middle = left + width / 2.0 + height * aside
    return np.stack([middle - wide / 2.0, top + height * up, wide, tall], axis=1)


def _iou(one: jax.Array, other: jax.Array) -> jax.Array:
    """Return the IoU (N,) of two sets of boxes, given as offsets (N, 4) from the same windows."""
    (low, high), (begin, end) = _corners(one), _corners(other)
    common = jnp.prod(jnp.maximum(jnp.minimum(high, end) - jnp.maximum(low, begin), 0.0), axis=1)
    either = jnp.prod(high - low, axis=1) + jnp.prod(end - begin, axis=1) - common
    return common / (either + _NOTHING)


def _corners(offsets: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return two opposite corners (N, 2), in window heights."""
    middle, top, height, half = offsets[:, 0], offsets[:, 1], jnp.exp(offsets[:, 2]), offsets[:, 3] / 2.0
    return jnp.stack([middle - half, top], axis=1), jnp.stack([middle + half, top + height], axis=1)
