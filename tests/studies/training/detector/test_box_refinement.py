from dataclasses import replace
from functools import partial
from pathlib import Path

import jax
import numpy as np
import pytest

from peopleboy.studies.training.detector.crop_samples import CropSamples, versions
from peopleboy.studies.training.detector.train_box_refinement import BoxRefinementTraining
from peopleboy.studies.training.detector.world_sequences import ThermalImage, load_images
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.sensors.thermal.detector.box_regression import decode_boxes
from peopleboy.tracker.sensors.thermal.detector.crops import normalise_crops
from peopleboy.tracker.sensors.thermal.detector.rescoring import BoxRefinementNetwork
from tests.helpers.images.drawn_crops import drawn_crops, drawn_weights, loss_of
from tests.helpers.images.drawn_films import drawn_film


@pytest.fixture(scope="module")
def shots(tmp_path_factory: pytest.TempPathFactory) -> list[ThermalImage]:
    path = Path(tmp_path_factory.mktemp("films")) / "film.npz"
    drawn_film(0, 4).save(path)
    return load_images([path])


def samples_of(images: list[ThermalImage], seed: int, count: int) -> CropSamples:
    drawn = versions(images, np.random.default_rng(seed), count)
    parts = [BoxRefinementTraining().sample(one, augments=count > 0) for one in drawn]
    return CropSamples.join([CropSamples.empty(BoxRefinementNetwork.ARCHITECTURE.crop, 6), *parts])


def test_boxes_are_about_people_and_offsets_lead_to_them(shots: list[ThermalImage]) -> None:
    looks = samples_of(shots, 0, 0)
    people = sum(len(shot.box) for shot in shots)
    assert 0 < len(looks.overlap) <= people
    assert looks.crops.shape[1:3] == BoxRefinementNetwork.ARCHITECTURE.crop[:2]
    assert len({len(each) for each in looks.arrays().values()}) == 1
    assert 0.6 < looks.overlap.mean() < 0.95
    assert np.abs(looks.offsets[:, 0]).max() < 0.2
    assert np.abs(looks.offsets[:, 2]).max() < 0.7
    edges = looks.offsets[:, 4:]
    known = ~np.isnan(edges).any(axis=1)
    assert known.any()
    assert (edges[known, 0] < edges[known, 1]).all()


def test_each_image_is_learned_from_four_times(shots: list[ThermalImage]) -> None:
    once = samples_of(shots, 1, 0)
    often = samples_of(shots, 1, 4)
    assert 2.0 * len(once.overlap) < len(often.overlap) <= 4.0 * sum(len(shot.box) for shot in shots)
    assert (once.features[:, 8] == 1.0).all()
    assert 0.2 < (often.features[:, 8] == 0.0).mean() < 0.7


def test_the_same_random_numbers_give_the_same_examples(shots: list[ThermalImage]) -> None:
    one, same = (samples_of(shots, 1, 4) for _ in range(2))
    for a, b in zip(one.arrays().values(), same.arrays().values(), strict=True):
        np.testing.assert_array_equal(a, b, strict=True)


def test_who_is_mostly_outside_is_not_learned_from(shots: list[ThermalImage]) -> None:
    shot = shots[0]
    box = np.array([[-9.0, 20.0, 10.0, 60.0], [50.0, 20.0, 3.0, 12.0]])
    both = np.ones(2, np.bool_)
    away = replace(
        shot,
        box=box,
        whole=box,
        is_good=both,
        is_clear=both,
        posture=np.zeros(2, np.int64),
        visible=np.ones(2),
    )
    assert len(samples_of([away], 0, 0).overlap) == 0


FORM = BoxRefinementNetwork.ARCHITECTURE
loss = jax.jit(partial(loss_of, BoxRefinementTraining()))
WINDOW = np.array([[40.0, 50.0, 20.0, 80.0]])


def test_the_loss_is_that_of_what_boxes_do_not_share_and_huber_s_of_places() -> None:
    looks, weights = drawn_crops(FORM, 6, targets=6), drawn_weights(FORM)
    planes = normalise_crops(looks.crops)
    ours = BoxRefinementNetwork(weights).predict(planes, looks.features)
    window = np.repeat(WINDOW, 6, axis=0)
    true = looks.offsets[:, :4].astype(np.float64)
    shared = iou(decode_boxes(window, ours[:, :4]), decode_boxes(window, true))
    off = np.abs(ours - looks.offsets) / BoxRefinementNetwork.SCALES
    bent = np.where(off < 1.0, off**2 / 2.0, off - 0.5)
    assert bent.max() < 8.0
    computed = loss(weights, planes, looks)
    units = 0.3 * bent[:, :4].mean() + 0.6 * bent[:, 4:].mean()
    assert float(computed[0]) == pytest.approx(4.0 * (1.0 - shared).mean() + units, rel=1e-3)
    assert float(computed[1]["units off"]) == pytest.approx(off.mean(), rel=1e-3)


def test_somebody_else_s_box_teaches_no_units() -> None:
    looks, weights = drawn_crops(FORM, 3, targets=6), drawn_weights(FORM)
    planes = normalise_crops(looks.crops)
    far = replace(looks, offsets=looks.offsets + np.float32(3.0))
    assert float(loss(weights, planes, far)[0]) == pytest.approx(4.0 + (0.3 + 0.6) * 8.0, rel=1e-5)


def test_the_score_of_what_was_found_says_nothing_of_where() -> None:
    looks, weights = drawn_crops(FORM, 3, targets=6), drawn_weights(FORM)
    planes, other = normalise_crops(looks.crops), looks.features.copy()
    other[:, 0] += 1.0
    one, same = (loss(weights, planes, replace(looks, features=n)) for n in (looks.features, other))
    assert float(one[0]) == float(same[0])
