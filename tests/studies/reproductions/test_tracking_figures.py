from __future__ import annotations

import numpy as np
import pytest

from peopleboy.studies.reproductions.experiments.playback import unbroken
from peopleboy.studies.reproductions.pictures.single_person_figures import filtered_images
from peopleboy.studies.reproductions.pictures.tracking_figures import (
    CANDIDATES,
    MATCHES,
    TARGETS,
    fitness_grey,
    score_error,
    score_example,
    shared,
)
from peopleboy.tracker.reproductions.contour.particles import draw_prior
from peopleboy.tracker.reproductions.contour.variants import THESIS, THESIS_SINGLE


@pytest.mark.parametrize(
    ("frames", "gap", "found"),
    [
        ([], 1, [[]]),
        ([4], 1, [[4]]),
        ([1, 2, 3, 7, 8, 10], 1, [[1, 2, 3], [7, 8], [10]]),
        ([1, 2, 3, 7, 8, 10], 2, [[1, 2, 3], [7, 8, 10]]),
    ],
)
def test_frames_fall_into_unbroken_stretches(frames: list[int], gap: int, found: list[list[int]]) -> None:
    assert [[frames[k] for k in run] for run in unbroken(frames, gap)] == found


def test_where_nothing_differs_nothing_fits_and_no_fit_is_beyond_the_cap() -> None:
    rng = np.random.default_rng(0)
    samples = draw_prior(200, (240, 320), THESIS.motion, THESIS.detector, rng)
    assert np.all(fitness_grey(np.full((240, 320), 90, np.uint8), samples) == 0.0)
    noise = rng.integers(0, 240, (240, 320)).astype(np.uint8)
    assert 0.0 < np.abs(fitness_grey(noise, samples)).max() <= 40.0


def test_only_what_looks_beyond_single_frames_sees_swapped_tracks() -> None:
    right, swapped, fetched = (score_error(name) for name in ("a) correct", "c) swapping", "d) fetching"))
    assert swapped.thesis == right.thesis
    assert swapped.paper.adc == right.paper.adc
    assert right.mot.identity.idf1 == 100.0 > swapped.mot.identity.idf1
    assert fetched.thesis.cr < right.thesis.cr == 100.0


def test_the_example_of_metrics_is_as_the_equations_say() -> None:
    areas = [shared(TARGETS[one], CANDIDATES[other]) for one, other in MATCHES]
    both = sum(width * height for _, _, width, height in areas)
    targets, candidates = (float(np.prod(boxes[:, 2:], axis=1).sum()) for boxes in (TARGETS, CANDIDATES))
    found = score_example().thesis
    assert (found.cr, found.cp, found.ca) == pytest.approx(
        (200 / 3, 200 / 3, 200 / 3)
    )  # equations 3.1 to 3.3
    assert found.aa == pytest.approx(100 * 2 * both / (targets + candidates))  # equation 3.6


def test_the_single_filter_is_drawn_with_all_its_samples_inside_the_image() -> None:
    *_, last = filtered_images("single_stationary", 0.5)
    assert last.time_s == pytest.approx(0.5, abs=0.07)
    assert last.middles.shape == (THESIS_SINGLE.person.count, 2)
    assert (last.middles >= 0.0).all()
    assert (last.middles < np.array(last.grey.shape[::-1])).all()
