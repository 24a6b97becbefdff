"""Conversion of panoramas of any camera to the view of the networks, against closed forms."""

import math

import numpy as np
import pytest

from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.tracker.sensors.panorama.panorama_view import all_round
from peopleboy.tracker.sensors.panorama.resampling import Resampling
from peopleboy.tracker.sensors.panorama.unrolling import PanoramaKind, PanoramaUnrolling
from tests.helpers.calls.refused import refused

HEIGHT_M = 1.2


def shade(bearing, elevation):
    """Return a smooth colour (..., 3) for each direction [rad]."""
    waves = np.sin(bearing), np.cos(2.0 * bearing), np.sin(3.0 * elevation)
    return np.stack([127.0 + 100.0 * (np.broadcast_to(wave, bearing.shape)) for wave in waves], axis=-1)


def picture(calibration):
    v, u = np.mgrid[: calibration.height, : calibration.width].astype(float)
    shaded = shade(calibration.bearing(u), -calibration.depression(v))
    return np.rint(shaded).astype(np.uint8)


def equirectangular(width, height, low_deg=-90.0, high_deg=90.0):
    return PanoramaUnrolling.of(
        PanoramaKind.EQUIRECTANGULAR, (width, height), (low_deg, high_deg), HEIGHT_M
    ).calibration


@pytest.mark.parametrize("camera", [
    equirectangular(960, 480), equirectangular(1920, 960), equirectangular(700, 350),
    equirectangular(480, 240, -70.0, 20.0), all_round(HEIGHT_M),
], ids=str)  # fmt: skip
def test_directions_keep_their_colours(camera):
    resampling = Resampling.of(camera)
    seen = resampling.image(picture(camera)).astype(int)
    assert resampling.rows == (0, 180)
    assert np.abs(seen - picture(resampling.calibration)).max() <= 3


def test_rows_that_the_camera_does_not_see_are_known():
    resampling = Resampling.of(equirectangular(960, 200, -45.0, -10.0))
    first, end = resampling.rows
    down = np.degrees(resampling.calibration.depression(np.array([first, end - 1.0])))
    assert down == pytest.approx([10.0, 45.0], abs=1.0)


def test_the_floor_of_a_cone_mirror_stays_where_it_is():
    mirror = PanoramaCalibration(
        width=480, height=120, focal_px=112.0, axis_rad=0.96, ring_radius_m=-0.023, ring_height_m=1.2
    )
    image = np.zeros((120, 480, 3), np.uint8)
    row = round(mirror.row(3.0, 0.0))
    image[row - 1 : row + 2] = 255
    resampling = Resampling.of(mirror)
    bright = np.flatnonzero(resampling.image(image)[:, 100, 0] > 128)
    assert resampling.calibration.floor_m(float(bright.mean())) == pytest.approx(3.0, abs=0.1)


@pytest.mark.parametrize("kind", [PanoramaKind.FISHEYE_UP, PanoramaKind.FISHEYE_DOWN, PanoramaKind.MIRROR])
def test_round_images_are_unrolled(kind):
    size, begin, end = 900, *{"fisheye-up": (90, -10), "fisheye-down": (-90, 5), "mirror": (-55, -8)}[kind]
    unrolling = PanoramaUnrolling.of(kind, (size + 40, size), (begin, end), HEIGHT_M)
    y, x = np.mgrid[:size, : size + 40].astype(float)
    ahead, right = (size - 1) / 2.0 - y, x - (size + 39) / 2.0
    share = np.hypot(ahead, right) / (size / 2.0)
    begin, end = math.radians(begin), math.radians(end)
    elevation = begin + share * (end - begin)
    if kind is PanoramaKind.MIRROR:
        elevation = begin + np.arctan(share * math.tan(end - begin))
    left = right if kind is not PanoramaKind.FISHEYE_DOWN else -right
    round_image = np.rint(shade(np.arctan2(left, ahead), elevation)).astype(np.uint8)
    panorama = unrolling.image(round_image).astype(int)
    expected = picture(unrolling.calibration).astype(int)
    steep = np.abs(unrolling.calibration.depression(np.arange(float(len(panorama)))) + begin) < 0.1
    assert np.abs(panorama - expected)[~steep].max() <= 3  # the centre of a round image is coarse


@pytest.mark.parametrize(("kind", "elevation_deg", "words"), [
    ("mirror", None, ("mirror", "elevations")),
    ("mirror", (-8.0, -55.0), ("rising", "-8", "-55")),
    ("fisheye-up", (-10.0, 90.0), ("falling",)),
    ("equirectangular", (-100.0, 90.0), ("-90 to 90", "-100")),
    ("unrolled", (-80.0, 20.0), ("less than 90 degrees",)),
])  # fmt: skip
def test_elevations_that_make_no_sense_are_refused(kind, elevation_deg, words):
    with refused(*words):
        PanoramaUnrolling.of(PanoramaKind(kind), (400, 400), elevation_deg, HEIGHT_M)


def test_an_equirectangular_image_has_square_pixels_unless_told_otherwise():
    camera = PanoramaUnrolling.of(PanoramaKind.EQUIRECTANGULAR, (1000, 300), None, HEIGHT_M).calibration
    assert camera.focal_px == pytest.approx(1000 / math.tau)
    assert camera.depression(np.array(149.5)) == pytest.approx(0.0, abs=1e-12)


def test_projection_into_an_equirectangular_image_inverts_its_rays():
    camera = equirectangular(960, 480)
    pixels = np.array([[0.0, 10.0], [300.5, 200.0], [959.0, 470.0]])
    points = camera.position_m + 3.0 * camera.rays(pixels)
    assert camera.project(points) == pytest.approx(pixels, abs=1e-9)
    assert camera.row(2.0, 0.0) == pytest.approx(camera.project(np.array([[2.0, 0.0, 0.0]]))[0, 1])
