import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.studies.training.detector.augmentation import mirror
from peopleboy.studies.training.detector.evaluation import evaluate_trees
from peopleboy.studies.training.detector.world_sequences import ThermalImage, load_images, render_thermal
from peopleboy.tracker.boxes import iou, shared_of_smaller
from peopleboy.tracker.sensors.thermal.detector.detector import SMALLEST_PX, PeopleDetector, detect_with_trees
from peopleboy.tracker.sensors.thermal.detector.people_trees import shipped_people_trees

Grey = NDArray[np.uint8]


@pytest.fixture(scope="module")
def shots(tmp_path_factory: pytest.TempPathFactory) -> list[ThermalImage]:
    """The first image of worlds that nobody learned from, and in which somebody is there by then."""
    folder = tmp_path_factory.mktemp("films")
    for seed in (3, 24, 28):  # in which people are there from the first image on
        render_thermal(random_scenario(seed, 0.3), seed).save(folder / f"{seed}.npz")
    return list(load_images(sorted(folder.iterdir())))


@pytest.mark.slow
def test_people_of_random_worlds_are_found(shots: list[ThermalImage]) -> None:
    found = evaluate_trees(shipped_people_trees(), shots, knows_mount=False)
    assert found.people >= 6
    assert found.recall(1.0) > 0.6
    assert found.overlap[found.is_person].mean() > 0.65


def test_a_known_mount_loses_hardly_anybody(shots: list[ThermalImage]) -> None:
    known, unknown = (
        evaluate_trees(shipped_people_trees(), shots, knows_mount=is_known) for is_known in (True, False)
    )
    assert known.is_person.sum() >= 0.85 * unknown.is_person.sum()


def test_a_mirrored_image_has_mirrored_people(shots: list[ThermalImage]) -> None:
    # Trees are not symmetric; those who are surely there are found on either side.
    sure = hits = 0
    for shot in shots:
        found, other = (
            detect_with_trees(shipped_people_trees(), one.grey, one.change, None, SMALLEST_PX, least)
            for one, least in ((shot, 2.0), (mirror(shot), 0.0))
        )
        back = other.box.copy()
        back[:, 0] = shot.grey.shape[1] - 1.0 - (back[:, 0] + back[:, 2])
        sure += len(found.box)
        hits += int((iou(found.box[:, None], back[None]) > 0.5).any(axis=1).sum())
    assert sure >= 5
    assert hits >= 0.8 * sure


@pytest.mark.parametrize(("gain", "offset"), [(0.8, 0.0), (1.0, 30.0), (0.7, 20.0)])
def test_gain_and_offset_hardly_matter(shots: list[ThermalImage], gain: float, offset: float) -> None:
    sure = hits = 0
    for shot in shots:
        image = (0.8 * shot.grey).round().astype(np.uint8)  # room at the upper end
        other = (gain * image + offset).round().astype(np.uint8)
        change, less = (0.8 * shot.change).astype(np.uint8), (0.8 * gain * shot.change).astype(np.uint8)
        found = detect_with_trees(shipped_people_trees(), image, change, None, SMALLEST_PX, 2.0)
        again = detect_with_trees(shipped_people_trees(), other, less, None, SMALLEST_PX, 0.0)
        sure += len(found.box)
        hits += int((iou(found.box[:, None], again.box[None]) > 0.6).any(axis=1).sum())
    assert sure >= 5
    assert hits >= 0.8 * sure


def test_scores_fall_and_nobody_below_the_least_is_told(shots: list[ThermalImage]) -> None:
    image = shots[0].grey
    found = PeopleDetector(least_score=0.5).update(image, 0.0)
    assert (np.diff(found.score) <= 0.0).all()
    assert (found.score >= 0.5).all()
    assert len(PeopleDetector(least_score=np.inf).update(image, 0.0).score) == 0


def test_who_is_known_is_passed_by_and_proposed_and_others_are_found_as_ever(
    shots: list[ThermalImage],
) -> None:
    seen = 0
    for shot in shots:
        found = detect_with_trees(shipped_people_trees(), shot.grey, shot.change, None, SMALLEST_PX, 0.0)
        for number in range(len(found.box)):
            one = found.take(np.array([number]))
            both = detect_with_trees(
                shipped_people_trees(), shot.grey, shot.change, None, SMALLEST_PX, 0.0, one
            )
            shared = shared_of_smaller(both.box, one.box)
            assert (shared > 0.65).sum() == 1
            assert iou(both.box[shared.argmax()], one.box[0]) > 0.8
            apart = found.take(shared_of_smaller(found.box, one.box) == 0.0)
            again = iou(apart.box[:, None], both.box[None])
            assert (again.max(axis=1, initial=0.0) > 0.9).all()
            seen += len(apart.box)
    assert seen >= 3
