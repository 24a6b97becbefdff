"""Tests of the ablations of the detection tracker and of the contour tracker."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from benchmarks.compare import Recording, record
from benchmarks.detection_ablation import LEAST, VARIANTS, DetectorOfStage, DetectorStage, thermal_finder
from benchmarks.tracker_ablation import STEPS, adopt, differing, step_of, variants
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.reproductions.contour.variants import CONTOUR, THESIS
from peopleboy.tracker.sensors.detections import NO_DETECTIONS
from peopleboy.tracker.sensors.thermal.detector.detector import PeopleDetector
from peopleboy.tracker.sensors.thermal.thermal_sensor import ThermalSensor
from peopleboy.tracker.tracking.people_tracker import PeopleTracker


@pytest.fixture(scope="module")
def recording() -> Recording:
    return record(load_scenario("crossing_2").lasting(1.0), 100)


@pytest.mark.thorough
def test_all_looks_together_are_those_of_the_detector(recording: Recording) -> None:
    whole, all_stages = PeopleDetector(least_score=LEAST), DetectorOfStage(DetectorStage.BOX_REFINEMENT)
    for frame in recording.frames:
        grey = frame.grey(THERMAL)
        expected = whole.update(grey, frame.time_s)
        for found, wanted in zip(all_stages.update(grey, frame.time_s), expected, strict=True):
            assert_array_equal(found, wanted)


def test_as_it_is_it_is_the_tracker(recording: Recording) -> None:
    tracker = PeopleTracker((ThermalSensor(),))
    expected = [tracker.update(frame) for frame in recording.frames]
    assert VARIANTS["as it is"].tracked(recording) == expected
    assert expected[-1]


def test_a_threshold_finds_people_by_the_greys_it_was_made_for_alone(recording: Recording) -> None:
    find = thermal_finder(DetectorStage.THRESHOLD)
    frame = recording.frames[-1]
    warmer = np.clip(frame.grey(THERMAL).astype(int) + 60, 0, 255).astype(np.uint8)
    assert len(find(frame, NO_DETECTIONS, everywhere=True).box) >= 1
    assert len(find(replace(frame, images={THERMAL: warmer}), NO_DETECTIONS, everywhere=True).box) == 0


def test_every_variant_is_another_tracker() -> None:
    assert len(set(map(repr, VARIANTS.values()))) == len(VARIANTS)


def test_what_is_not_known_of_cameras_is_left_out(recording: Recording) -> None:
    assert recording.frames[0].calibrations
    assert not any(frame.calibrations for frame in recording.uncalibrated().frames)
    assert np.shares_memory(
        recording.uncalibrated().frames[0].images[THERMAL], recording.frames[0].images[THERMAL]
    )


def test_all_steps_together_lead_from_the_thesis_tracker_to_the_default_one() -> None:
    steps = [config for name, config in variants() if name.startswith("+ ")]
    assert len(steps) == len(STEPS)
    assert steps[-1] == CONTOUR
    assert len(set(map(repr, steps))) == len(steps)


def test_every_setting_in_which_they_differ_belongs_to_a_step() -> None:
    settings = list(differing(THESIS, CONTOUR))
    assert {step_of(name) for name in settings} == set(STEPS)
    assert adopt(THESIS, CONTOUR, settings) == CONTOUR
