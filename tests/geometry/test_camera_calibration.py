from __future__ import annotations

import math

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.sim.geometry.panorama import MIRRORS, Panorama
from peopleboy.sim.geometry.pinhole import invert_pose, transform

CAMERAS = pytest.mark.parametrize(
    "camera", [Panorama(mirror=mirror) for mirror in MIRRORS.values()], ids=MIRRORS
)


def calibration(camera: Panorama) -> PanoramaCalibration:
    found = camera.calibration
    assert isinstance(found, PanoramaCalibration)
    return found


@CAMERAS
def test_a_tracker_projects_as_the_camera_does(camera: Panorama) -> None:
    points = np.random.default_rng(1).uniform((-6.0, -6.0, 0.0), (6.0, 6.0, 2.0), (200, 3))
    expected = camera.project(transform(invert_pose(camera.robot_from_camera), points))
    np.testing.assert_allclose(calibration(camera).project(points), expected, atol=1e-9)


@CAMERAS
def test_what_a_pixel_sees_on_the_floor_is_projected_to_it(camera: Panorama) -> None:
    u, v = np.meshgrid(np.arange(0, camera.width, 9.0), np.arange(0, camera.height, 7.0))
    pixels, told = np.stack([u.ravel(), v.ravel()], axis=1), calibration(camera)
    rays = told.rays(pixels)
    outwards = rays[:, :2] / np.linalg.norm(rays[:, :2], axis=1, keepdims=True)
    start = np.insert(told.ring_radius_m * outwards, 2, told.ring_height_m, axis=1)
    landed = start - rays * start[:, 2:] / rays[:, 2:]
    np.testing.assert_allclose(told.project(landed), pixels, atol=1e-6)


def test_a_column_beyond_the_seam_is_one_on_its_other_side() -> None:
    told = calibration(Panorama())
    here, beyond = told.bearing(np.array([3.0])), told.bearing(np.array([483.0]))
    np.testing.assert_allclose(here, beyond)
    assert told.bearing(np.array([239.5, 119.5, 359.5])) == pytest.approx([0.0, math.pi / 2, -math.pi / 2])


def test_numbers_that_are_no_calibration_are_refused() -> None:
    values = {"axis_rad": 1.0, "ring_radius_m": 0.0, "ring_height_m": 1.7}
    for focal in (math.nan, 0.0):
        with pytest.raises(BadInput, match=str(focal)):
            PanoramaCalibration(width=480, height=120, focal_px=focal, **values)
