"""Samples of laser scans: what is labelled as a person is where the person is."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

pytest.importorskip("jax")

from peopleboy.studies.training.legs import LEAST_BEAMS, Scans, sample_beams, scan_random
from peopleboy.tracker.sensors.laser.scan_windows import SIZE, cut_windows


@cache
def scans(kind: str, seed: int) -> Scans:
    return scan_random(kind, seed)


def test_equal_seeds_give_equal_scans_of_a_range_finder_with_drawn_settings() -> None:
    first, again = scans("scene", 100), scan_random("scene", 100)
    assert np.array_equal(first.ranges, again.ranges)
    assert np.array_equal(first.person, again.person)
    others = {(one.ranges.shape[1], float(one.mount[2])) for one in (first, scans("world", 20_000))}
    assert len(others) == 2


def test_offsets_lead_from_the_hit_point_to_the_middle_of_the_person() -> None:
    one = scans("scene", 100)
    samples = sample_beams(one, np.random.default_rng(0))
    is_person = ~np.isnan(samples.offset_m[:, 0])
    assert samples.inputs.shape == (len(samples), SIZE)
    assert is_person.sum() > 100
    assert np.hypot(*samples.offset_m[is_person].T).max() < 0.9  # half a stride and a body
    assert samples.offset_m[is_person, 0].mean() > 0.0  # the middle lies behind the surface


def test_only_people_with_readings_have_to_be_found() -> None:
    one = scans("world", 20_000)
    for k, ranges in enumerate(one.ranges):
        beams, _ = cut_windows(ranges, one.calibration)
        hits = np.bincount(one.person[k][beams], minlength=len(one.place_m[k]) + 1)[1:]
        places, is_counted = one.people(k)
        assert is_counted.sum() == (hits >= LEAST_BEAMS).sum()
        assert np.isfinite(places).all()
