"""Train the network of box refinement on boxes round people, displaced as those of rescoring are."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Final

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.detector.augmentation import Version
from peopleboy.studies.training.detector.crop_samples import (
    CropData,
    CropSamples,
    CropTraining,
    mean_overlaps,
    predictions,
)
from peopleboy.studies.training.detector.world_sequences import ThermalImage
from peopleboy.studies.training.optimiser import huber
from peopleboy.tracker.boxes import area, cover, intersection, iou
from peopleboy.tracker.detector.box_regression import encode_boxes
from peopleboy.tracker.detector.detections import Detections
from peopleboy.tracker.detector.rescoring import BoxRefinementNetwork
from peopleboy.tracker.detector.window import Floats

_HARDLY_VISIBLE: Final = 0.3  # of people that are hidden or not upright are trained on
_INSIDE: Final = 0.25  # of a box, at least
_TALL_PX: Final = 16.0
# Errors of rescored boxes: deviations of middle, head and feet in heights, of the width's logarithm.
_MIDDLE, _HEAD, _FEET, _WIDTH = 0.018, 0.03, 0.055, 0.1
_FAR_OFF: Final = 0.3  # of boxes
_FARTHER: Final = 2.2  # times as far
_LOWEST: Final = 0.4  # least height of a box in heights of its person

_OVERLAP: Final = 4.0  # weight of 1 - IoU
_UNITS: Final = 0.3  # weight of errors in units
_LINEAR_FROM: Final = 1.0  # units
_MOST: Final = 8.0  # of the loss of a unit: a box that is farther off is of another person
_CLIPPED: Final = 12.0  # units, as boxes that are wildly off have no gradient of IoU
_NOTHING: Final = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class BoxRefinementTraining(CropTraining):
    """Train on people in random worlds that the cascade was not trained on."""

    NETWORK: ClassVar[type[BoxRefinementNetwork]] = BoxRefinementNetwork
    EPOCHS: ClassVar[int] = 2
    DROPOUT: ClassVar[float] = 0.2
    VERSIONS: ClassVar[int] = 4

    def sample(self, version: Version, *, augments: bool) -> CropSamples:  # noqa: ARG002
        """Collect the people of an image, with displaced boxes."""
        people = version.image.box[_is_sampled(version.image, version.rng)]
        boxes = _displace(people, version.rng)
        found = Detections.from_trees(boxes, np.zeros(len(boxes)))
        size = self.NETWORK.ARCHITECTURE.crop
        return CropSamples.cut(version, found, iou(boxes, people), encode_boxes(boxes, people), size)

    def check(self, others: CropSamples) -> None:
        """Refuse sequences without people."""
        if not len(others):
            raise BadInput("no people are visible in the validation sequences; take more sequences")

    def loss(self, outputs: jax.Array, batch: CropSamples) -> tuple[jax.Array, dict[str, jax.Array]]:
        """Return the losses of overlap (Yu et al., UnitBox 2016) and of offsets in units."""
        scales, usual = self.NETWORK.SCALES, self.NETWORK.USUAL
        off = jnp.abs(outputs - (batch.offsets - usual) / scales)
        offsets = jnp.clip(outputs, -_CLIPPED, _CLIPPED) * scales + usual
        overlap = _iou(offsets, jnp.asarray(batch.offsets))
        units = jnp.minimum(huber(off, _LINEAR_FROM), _MOST).mean(axis=1)
        whole = _OVERLAP * (1.0 - overlap) + _UNITS * units
        return whole.mean(), {"overlap": overlap.mean(), "units off": off.mean()}

    def evaluate(self, model: BoxRefinementNetwork, data: CropData) -> Mapping[str, str]:
        """Measure by how much boxes are nearer to people."""
        others = data.samples.validation
        rows = np.ones(len(others), np.bool_)
        before, after = mean_overlaps(predictions(model, others), others, rows)
        result = f"{len(rows)} boxes: mean overlap {before:.3f} before, {after:.3f} refined"
        return {f"on {len(data.tasks.validation)} others": result}


def _is_sampled(image: ThermalImage, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Return which people (P,) are visible enough, and draw some of the others."""
    rows, columns = image.grey.shape
    whole = np.array([0.0, 0.0, columns, rows])
    is_inside = cover(intersection(image.box, whole), area(image.box)) > _INSIDE
    is_visible = image.is_good | image.is_clear | (rng.random(len(image.box)) < _HARDLY_VISIBLE)
    return np.asarray(is_visible & is_inside & (image.box[:, 3] > _TALL_PX), np.bool_)


def _displace(people: Floats, rng: np.random.Generator) -> Floats:
    """Displace boxes of people (P, 4) as those of rescoring are: some more, some less."""
    left, top, width, height = people.T
    far = np.where(rng.random(len(people)) < _FAR_OFF, _FARTHER, 1.0)
    aside, up, down, wider = (
        far * rng.normal(0.0, off, len(people)) for off in (_MIDDLE, _HEAD, _FEET, _WIDTH)
    )
    wide, tall = width * np.exp(wider), height * np.maximum(1.0 + down - up, _LOWEST)
    middle = left + width / 2.0 + height * aside
    return np.stack([middle - wide / 2.0, top + height * up, wide, tall], axis=1)


def _iou(one: jax.Array, other: jax.Array) -> jax.Array:
    """Return the IoU (N,) of boxes by their offsets (N, 4) from the same windows."""
    (low, high), (begin, end) = _corners(one), _corners(other)
    common = jnp.prod(jnp.maximum(jnp.minimum(high, end) - jnp.maximum(low, begin), 0.0), axis=1)
    either = jnp.prod(high - low, axis=1) + jnp.prod(end - begin, axis=1) - common
    return common / (either + _NOTHING)


def _corners(offsets: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return two corners (N, 2), in heights of the window."""
    middle, top, height, half = offsets[:, 0], offsets[:, 1], jnp.exp(offsets[:, 2]), offsets[:, 3] / 2.0
    return jnp.stack([middle - half, top], axis=1), jnp.stack([middle + half, top + height], axis=1)
