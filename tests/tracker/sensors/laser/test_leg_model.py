"""Detection of legs in scans that are computed in closed form, and its parts."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import ScanCalibration
from peopleboy.tracker.networks.weights_archive import WeightsArchive
from peopleboy.tracker.sensors.laser.beam_votes import APART_M, Votes, group_votes, vote_places
from peopleboy.tracker.sensors.laser.leg_model import LegModel
from peopleboy.tracker.sensors.laser.scan_windows import SIZE, WINDOW, cut_windows

LEG_M = 0.055


def calibration(beams: int = 360) -> ScanCalibration:
    return ScanCalibration(beams=beams, step_rad=math.pi / beams, position_m=(0.2, 0.0, 0.3))


def scan(*legs: tuple[float, float], beams: int = 360, wall_m: float = 8.0) -> np.ndarray:
    """Scan round legs at places in the robot's frame before a round wall, in millimetres."""
    bearing = calibration(beams).bearings
    reach = np.full(beams, wall_m)
    for x, y in legs:
        along = (x - 0.2) * np.cos(bearing) + y * np.sin(bearing)
        aside = -(x - 0.2) * np.sin(bearing) + y * np.cos(bearing)
        near = along - np.sqrt(np.maximum(LEG_M**2 - aside**2, 0.0))
        reach = np.where((np.abs(aside) < LEG_M) & (along > 0.0), np.minimum(reach, near), reach)
    return np.rint(1000.0 * reach).astype(np.uint16)


@pytest.mark.parametrize("beams", [360, 720])
@pytest.mark.parametrize("place", [(2.0, 0.5), (3.5, -1.0), (4.5, 2.0)])
def test_a_pair_of_legs_is_a_person_in_their_middle(beams: int, place: tuple[float, float]) -> None:
    x, y = place
    found = LegModel.load().detect(scan((x, y + 0.12), (x + 0.1, y - 0.12), beams=beams), calibration(beams))
    best = int(found.scores.argmax())
    assert found.scores[best] > 1.0
    assert found.places_m[best] == pytest.approx((x + 0.05, y), abs=0.2)


def test_an_empty_room_and_a_scan_without_a_reading_have_no_person() -> None:
    model = LegModel.load()
    assert (model.detect(scan(), calibration()).scores < 0.0).all()
    assert len(model.detect(np.zeros(360, np.uint16), calibration()).scores) == 0


def test_a_window_is_the_same_at_every_range_up_to_its_resolution() -> None:
    for x in (1.5, 3.0):
        ranges = scan((x, 0.0), beams=1440)
        beams, inputs = cut_windows(ranges, calibration(1440))
        (row,) = np.flatnonzero(beams == 720)
        assert inputs.shape == (len(beams), SIZE)
        is_leg = inputs[row, :WINDOW] < 0.5
        assert is_leg.sum() * 1.6 / WINDOW == pytest.approx(2.0 * LEG_M, abs=0.05)
        assert (inputs[row, :WINDOW][~is_leg] == 1.0).all()


def test_votes_point_at_offsets_along_and_to_the_left_of_their_beams() -> None:
    beams, metres = np.array([0, 359]), np.array([2.0, 2.0])
    left, right = vote_places(beams, metres, np.array([[0.1, 0.0], [0.0, 0.3]]), calibration())
    assert left == pytest.approx((0.2 + 2.1 * math.sin(math.radians(0.25)), 2.1), abs=1e-3)
    assert right == pytest.approx((0.5, -2.0), abs=1e-2)


def test_votes_are_grouped_around_the_strongest() -> None:
    places = np.array([[2.0, 0.0], [2.0, 0.9 * APART_M], [2.0, 1.1 * APART_M], [4.0, 0.0]])
    groups = group_votes(Votes(places, np.array([2.0, 0.0, 0.0, 1.0]), places[:, 0]), calibration())
    assert len(groups.places_m) == 3
    assert groups.places_m[0, 1] < 0.5 * APART_M
    assert groups.places_m[1] == pytest.approx((4.0, 0.0))


def test_other_weights_are_refused(tmp_path: Path) -> None:
    WeightsArchive({"beam.0.weights": np.zeros((3, 4), np.float16)}).save(tmp_path / "legs.npz")
    with pytest.raises(BadInput, match="peopleboy train legs"):
        LegModel.load(tmp_path / "legs.npz")
