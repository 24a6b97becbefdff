from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import jax
import numpy as np
import pytest

from peopleboy.studies.training.detector import people_samples, train_people
from peopleboy.studies.training.detector.people_samples import CANVAS, Batch, batch_of, sample_of
from peopleboy.studies.training.detector.train_people import (
    BATCH,
    batches,
    calibrated,
    evaluate_network,
    first_weights,
    fit_weights,
    forward,
)
from peopleboy.studies.training.detector.world_sequences import ThermalImage
from peopleboy.tracker.networks.convolution import Workspace
from peopleboy.tracker.sensors.thermal.detector.people_network import (
    BOX,
    OUTPUTS,
    PLANES,
    STRIDES,
    PeopleNetwork,
    decode,
)

LINE = {"line": np.array([1.0, 0.0], np.float32)}


def outputs_of(target: np.ndarray) -> np.ndarray:
    """Outputs that reach a target exactly."""
    outputs = np.full((*target.shape[:2], OUTPUTS), -9.0, np.float32)
    outputs[..., 0] = np.where(target[..., 0] >= 1.0, 9.0, -9.0)
    outputs[..., 1 : 1 + BOX] = target[..., 3 : 3 + BOX]
    return outputs


def test_outputs_that_reach_the_target_give_the_true_boxes(shots: list[ThermalImage]) -> None:
    rng = np.random.default_rng(0)
    for shot in shots[:12]:
        _, targets = sample_of(shot, rng)
        found = decode({stride: outputs_of(one) for stride, one in targets.items()}, 0.0, (1.0, 0.0))
        if not len(found.box):
            continue
        _, top, width, height = found.box.T
        np.testing.assert_allclose(width / height, 0.3, rtol=1e-4)  # as drawn, at every scale
        np.testing.assert_allclose(found.edges[:, 1] - found.edges[:, 0], 1.4 * width / height, rtol=1e-4)
        np.testing.assert_allclose(found.edges.sum(axis=1), 0.0, atol=1e-3)
        assert ((top < CANVAS[0]) & (top + height > 0)).all()


def test_hidden_and_small_people_are_ignored(shots: list[ThermalImage]) -> None:
    for hidden in (replace(shots[0], visible=np.zeros(1)), replace(shots[0], box=shots[0].box * 0.1)):
        whole = hidden.whole * (0.1 if hidden.box[0, 3] < 10.0 else 1.0)
        samples = [
            sample_of(replace(hidden, whole=whole), np.random.default_rng(seed))[1] for seed in range(8)
        ]
        assert all((target[..., 0] < 1.0).all() for every in samples for target in every.values())
        assert any((target[..., 1] == 0.0).any() for every in samples for target in every.values())


def test_people_who_cannot_be_seen_are_ignored(
    shots: list[ThermalImage], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(people_samples, "_AS_RENDERED", 1.0)
    flat = replace(shots[0], grey=np.full_like(shots[0].grey, 90))

    def highest_of(image: ThermalImage) -> float:
        targets = [sample_of(image, np.random.default_rng(seed))[1] for seed in range(6)]
        return max(float(target[..., 0].max()) for every in targets for target in every.values())

    assert highest_of(flat) < 1.0 == highest_of(shots[0])


def test_the_trained_network_is_the_one_that_runs() -> None:
    weights = first_weights(np.random.default_rng(0))
    planes = np.random.default_rng(1).standard_normal((1, 96, 128, PLANES)).astype(np.float32)
    ours = PeopleNetwork({**weights, **LINE}).maps(planes, Workspace())
    with jax.default_matmul_precision("highest"):
        trained = forward(weights, planes)
    assert set(ours) == set(trained) == set(STRIDES)
    for stride in STRIDES:
        np.testing.assert_allclose(ours[stride], trained[stride][0], atol=2e-4)


@pytest.mark.thorough
def test_batches_are_the_same_for_the_same_random_numbers(shots: list[ThermalImage]) -> None:
    one, same = (list(batches(shots, np.random.default_rng(2), 2)) for _ in range(2))
    for (planes, targets), (others, other_targets) in zip(one, same, strict=True):
        assert planes.shape == (BATCH, *CANVAS, PLANES)
        np.testing.assert_array_equal(planes, others)
        for stride in STRIDES:
            np.testing.assert_array_equal(targets[stride], other_targets[stride])


@pytest.mark.thorough
def test_a_few_drawn_people_are_learned(shots: list[ThermalImage], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(people_samples, "_AS_RENDERED", 1.0)
    monkeypatch.setattr(train_people, "batches", batches_of_16)
    network = PeopleNetwork(fit_weights(shots, 60))
    network = calibrated(network, shots[:12])
    assert float(evaluate_network(network, shots, knows_mount=True).split("AP50 ")[1].split(";")[0]) > 15.0


def batches_of_16(shots: list[ThermalImage], rng: np.random.Generator, count: int) -> Iterator[Batch]:
    """Batches that are prepared here, where what is patched counts."""
    for _ in range(count):
        own = [shots[row] for row in rng.choice(len(shots), 16)]
        yield batch_of(own, int(rng.integers(2**63))).take()
