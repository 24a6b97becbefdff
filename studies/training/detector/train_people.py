"""Train the network that detects people of all postures: CenterNet's loss (Zhou et al. 2019) on four maps."""

import math
import os
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Annotated, Any, ClassVar, Final

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.studies.training.detector.evaluation import log_odds_line
from peopleboy.studies.training.detector.people_samples import (
    POSTURE_OF,
    Batch,
    Floats,
    SharedBatch,
    batch_of,
)
from peopleboy.studies.training.detector.world_sequences import ThermalImage, load_images, render_task
from peopleboy.studies.training.detector.worlds import seeds_of
from peopleboy.studies.training.optimiser import Optimiser, Weights, he_weights
from peopleboy.studies.training.samples import Split, Tasks
from peopleboy.studies.training.specification import Specification, report
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.evaluation.average_precision import average_precision
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.networks.convolution import Workspace
from peopleboy.tracker.sensors.thermal.detector.people_network import (
    BOX,
    LAYERS,
    SHIFT,
    STRIDES,
    NetworkDetections,
    PeopleNetwork,
    parts_of,
)
from peopleboy.tracker.track import TrackPosture

Draw = np.random.Generator

VALIDATION: Final = 30
"""Number of worlds for evaluating the network: those of the first seeds."""
BATCH: Final = 32
_AHEAD: Final = 3  # batches that each process prepares ahead
_RATE: Final = 2e-3
_WARM_UP: Final = 200  # batches
_DECAY: Final = 0.02  # weight decay of kernels per batch, relative to the learning rate
_REPORTED: Final = 200  # batches between two progress lines
_HELD_BACK: Final = 10  # one in so many worlds is held out for the calibration of scores
_MOST_DRAWN: Final = 4  # people from whose number on images are not drawn more often
_SCORE_OF_NONE: Final = -4.0  # initial log-odds
_FIRST: Final = {"out": 0.1, "body": 0.5}  # gain of the initial weights of these layers, relative to He's
# Weights of the six numbers of a box, so that each stands for about the same share of the height.
_UNITS: Final = (SHIFT, SHIFT, 0.6, 0.3, 0.15, 0.15)
_BOXES: Final = 4.0  # weight of the loss of boxes relative to that of scores ...
_POSTURES: Final = 0.15  # ... and of that of postures
_SMOOTH: Final = 0.05  # error from which on the loss of boxes is linear
_WEAKEST: Final = -6.0  # log-odds of the weakest detections for calibration
_HIT: Final = 0.5  # IoU
_COUNTED_PX: Final = 24.0
_COUNTED_VISIBLE: Final = 0.4


@dataclass(frozen=True, slots=True, kw_only=True)
class PeopleTraining(Specification[Tasks]):
    """The network is trained on random worlds with people of all ages and postures."""

    HINT: ClassVar[str] = "`peopleboy run postures --detector runs/detector/people.npz` uses it"

    sequences: Annotated[
        int, Field(ge=10, le=2000, alias="seeds", description="Number of random worlds to train on.")
    ] = 600
    steps: Annotated[int, Field(ge=1, description=f"Number of batches of {BATCH} images.")] = 6000

    def default_folder(self, model: str) -> Path:  # noqa: ARG002
        """Return the folder that all models of the detector share."""
        return Path("runs/detector")

    def tasks(self, out: Path) -> Tasks:
        """Render the worlds."""
        seeds = seeds_of(self.sequences), range(VALIDATION)
        return Split(*([render_task(out / "sequences", seed) for seed in part] for part in seeds))

    def fit(self, data: Tasks) -> Mapping[str, PeopleNetwork]:
        """Train the network, and calibrate its scores on the worlds held out."""
        held = data.training[_HELD_BACK - 1 :: _HELD_BACK]
        images = load_images(task.path for task in data.training if task not in held)
        report(f"{len(images)} images, {sum(len(image.box) for image in images)} people")
        weights = fit_weights(images, self.steps)
        worlds = f"{self.sequences} random worlds, {len(held)} of them held out"
        network = PeopleNetwork(weights, {"people": f"{worlds}; {self.steps} batches"})
        others = load_images(task.path for task in held)
        return {f"{PeopleNetwork.MODEL}.npz": calibrated(network, others)}

    def evaluate(self, model: PeopleNetwork, data: Tasks) -> Mapping[str, str]:
        """Evaluate detections in the validation worlds."""
        images = load_images(task.path for task in data.validation)
        return {
            f"on worlds 0 to {VALIDATION - 1}, {mount}": evaluate_network(model, images, knows_mount=knows)
            for mount, knows in (("mount known", True), ("mount unknown", False))
        }


def fit_weights(
    images: Sequence[ThermalImage], steps: int, before: Weights | None = None, seed: int = 0
) -> dict[str, Floats]:
    """Train the weights on images, from initial ones or from those of an earlier training."""
    rng = np.random.default_rng(seed)
    optimiser = Optimiser(loss, before or first_weights(rng), decay=_DECAY, averages=True)
    results: list[dict[str, jax.Array]] = []
    for number, batch in enumerate(batches(images, rng, steps)):
        warm = min((number + 1) / _WARM_UP, 1.0)
        rate = _RATE * warm * 0.5 * (1.0 + math.cos(math.pi * number / steps))
        results.append(optimiser.step(batch, rate))
        if (number + 1) % _REPORTED == 0 or number + 1 == steps:
            means = {name: float(np.mean([float(one[name]) for one in results])) for name in results[0]}
            report(f"step {number + 1}: " + ", ".join(f"{name} {mean:.3f}" for name, mean in means.items()))
            results = []
    return optimiser.weights | {"line": np.array([1.0, 0.0], np.float32)}


def batches(images: Sequence[ThermalImage], rng: Draw, count: int) -> Iterator[Batch]:
    """Yield batches, prepared by as many processes as there are cores; the batches don't depend on how many.

    Images with people are drawn more often.
    """
    weight = np.array([1.0 + min(len(image.box), _MOST_DRAWN) for image in images])
    cores = os.cpu_count() or 1
    ready: deque[Future[SharedBatch]] = deque()
    with ProcessPoolExecutor(cores, get_context("spawn")) as processes:
        for _ in range(count):
            rows = rng.choice(len(images), BATCH, p=weight / weight.sum())
            own = [images[row] for row in rows]
            ready.append(processes.submit(batch_of, own, int(rng.integers(2**63))))
            if len(ready) > _AHEAD * cores:
                yield ready.popleft().result().take()
        while ready:
            yield ready.popleft().result().take()


def first_weights(rng: Draw) -> Weights:
    """Draw the initial weights."""
    weights: Weights = {}
    for name, (layer, depth) in LAYERS.items():
        inputs = layer.side * layer.side * depth
        gain = np.float32(_FIRST.get(name.rstrip("0123456789ab"), 1.0))
        weights[f"{name}_kernel"] = gain * he_weights(rng, (inputs, layer.planes), inputs)
        weights[f"{name}_bias"] = np.zeros(layer.planes, np.float32)
    for stride in STRIDES:
        weights[f"out{stride}_bias"][0] = _SCORE_OF_NONE
    return weights


def forward(weights: Weights, planes: jax.Array) -> dict[int, jax.Array]:
    """Return the maps (N, H', W', 12) by stride for inputs (N, H, W, 5), as `PeopleNetwork` does."""

    def linear(name: str, inputs: jax.Array) -> jax.Array:
        layer, depth = LAYERS[name]
        edge = layer.side // 2
        outputs = jax.lax.conv_general_dilated(
            inputs,
            weights[f"{name}_kernel"].reshape(layer.side, layer.side, depth, layer.planes),
            (layer.stride, layer.stride),
            [(edge, edge)] * 2,
            dimension_numbers=("NHWC", "HWIO", "NHWC"),
        )
        return jnp.asarray(outputs + weights[f"{name}_bias"])

    def layer(name: str, inputs: jax.Array) -> jax.Array:
        return jax.nn.relu(linear(name, inputs))

    here, seen = layer("stem", planes), {}
    for stride in STRIDES:
        here = layer(f"down{stride}", here)
        for name in parts_of(stride):
            here = here + layer(name, here)
        seen[stride] = here
    maps = {STRIDES[-1]: linear(f"out{STRIDES[-1]}", here)}
    for stride in reversed(STRIDES[:-1]):
        above = layer(f"into{stride}", here)
        here = layer(f"side{stride}", seen[stride]) + above.repeat(2, axis=1).repeat(2, axis=2)
        maps[stride] = linear(f"out{stride}", layer(f"head{stride}", here))
    return maps


def loss(weights: Weights, batch: Any, key: jax.Array) -> tuple[jax.Array, dict[str, jax.Array]]:  # noqa: ARG001
    """Return the sum of the losses of scores (focal), boxes (smooth L1) and postures (cross entropy)."""
    planes, targets = batch
    sums = jnp.zeros(5)
    for stride, outputs in forward(weights, planes.astype(jnp.float32)).items():
        sums += _sums(outputs, targets[stride].astype(jnp.float32))
    people, regressed = jnp.maximum(sums[0], 1.0), jnp.maximum(sums[1], 1.0)
    scores, boxes, postures = sums[2] / people, sums[3] / regressed, sums[4] / regressed
    total = scores + _BOXES * boxes + _POSTURES * postures
    return total, {"loss": total, "scores": scores, "boxes": boxes, "postures": postures}


def _sums(outputs: jax.Array, target: jax.Array) -> jax.Array:
    """Return the number of people, the weight of boxes, and the sums of the three losses, (5,)."""
    heat, counted, trained = target[..., 0], target[..., 1], target[..., 2]
    share, is_person = jax.nn.sigmoid(outputs[..., 0]), heat >= 1.0
    hit = (1.0 - share) ** 2 * jax.nn.softplus(-outputs[..., 0])
    miss = counted * (1.0 - heat) ** 4 * share**2 * jax.nn.softplus(outputs[..., 0])
    off = jnp.abs(outputs[..., 1 : 1 + BOX] - target[..., 3 : 3 + BOX])
    smooth = jnp.where(off < _SMOOTH, 0.5 * off * off / _SMOOTH, off - 0.5 * _SMOOTH)
    known = jax.nn.one_hot(target[..., -1].astype(jnp.int32), len(TrackPosture))
    entropy = -(known * jax.nn.log_softmax(outputs[..., 1 + BOX :])).sum(-1)
    return jnp.stack(
        [
            is_person.sum(),
            trained.sum(),
            jnp.where(is_person, hit, miss).sum(),
            (trained * (jnp.array(_UNITS) * smooth).sum(-1)).sum(),
            (trained * entropy).sum(),
        ]
    )


def calibrated(network: PeopleNetwork, images: Sequence[ThermalImage]) -> PeopleNetwork:
    """Return the network with scores that are log-odds in images (Platt 1999), occluded people included."""
    scores, is_person, workspace = [], [], Workspace()
    for image in images:
        for mount in (image.mount, None):
            found = network.detect(image.grey, image.change, mount, _WEAKEST, workspace)
            overlap = iou(found.box[:, None], image.box[None])
            scores += found.score.tolist()
            is_person += np.any(overlap >= _HIT, axis=1).tolist()
    line = np.array(log_odds_line(np.array(scores), np.array(is_person, np.bool_)), np.float32)
    return PeopleNetwork({**network.weights, "line": line}, network.about)


def evaluate_network(network: PeopleNetwork, images: Sequence[ThermalImage], *, knows_mount: bool) -> str:
    """Describe average precision, and recall and naming by posture at log-odds of 0."""
    workspace, people, found = Workspace(), [], []
    right = np.zeros((3, len(TrackPosture)), np.int64)  # people, detected, and named correctly
    for frame, image in enumerate(images, 1):
        mount = image.mount if knows_mount else None
        one = network.detect(image.grey, image.change, mount, _WEAKEST, workspace)
        counted = (image.box[:, 3] >= _COUNTED_PX) & (image.visible >= _COUNTED_VISIBLE)
        people += [(frame, k, image.box[k], counted[k], 1.0) for k in range(len(image.box))]
        found += [(frame, k, one.box[k], one.score[k]) for k in range(len(one.box))]
        right += _named(one, image.box[counted], POSTURE_OF[image.posture[counted]])
    precision = average_precision(TrueBoxes.from_rows(people), TrackBoxes.from_rows(found))
    postures = ", ".join(
        f"{posture} {detected}/{named} of {count}"
        for posture, count, detected, named in zip(TrackPosture, *right.tolist(), strict=True)
    )
    return f"AP {precision.ap:.1f}, AP50 {precision.ap50:.1f}; detected/named: {postures}"


def _named(
    found: NetworkDetections, box: NDArray[np.float64], posture: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the numbers of people, of those detected, and of those with the right posture, (3, 5)."""
    sure = found.score >= 0.0
    overlap = iou(box[:, None], found.box[None, sure])
    best = overlap.max(axis=1, initial=0.0) >= _HIT
    named = best.copy()
    if sure.any():
        named &= found.posture[sure].argmax(axis=1)[overlap.argmax(axis=1)] == posture
    every = np.ones_like(best)
    return np.stack(
        [np.bincount(posture[rows], minlength=len(TrackPosture)) for rows in (every, best, named)]
    )
