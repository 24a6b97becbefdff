import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.by_detection.config import STATURE_M
from peopleboy.tracker.by_detection.other_camera import carried_over
from peopleboy.tracker.by_detection.viewpoint import Viewpoint
from peopleboy.tracker.frame import PinholeCalibration

SHAPE = (240, 320)


def calibration(aside_m: float = 0.0, height_m: float = 1.2, focal: float = 300.0) -> PinholeCalibration:
    pose = np.eye(4)
    pose[:3, :3] = [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
    pose[:3, 3] = [0.1, aside_m, height_m]
    return PinholeCalibration(np.array([[focal, 0.0, 159.5], [0.0, focal, 119.5], [0.0, 0.0, 1.0]]), pose)


def seen(camera: PinholeCalibration, ahead_m: float, left_m: float) -> np.ndarray:
    """Box of somebody of the usual stature, .46 m wide."""
    ends = np.array([[ahead_m, left_m, STATURE_M], [ahead_m, left_m, 0.0]])
    (column, top), (_, bottom) = camera.project(ends)
    width = 0.46 * (bottom - top) / STATURE_M
    return np.array([column - width / 2.0, top, width, bottom - top])


@given(st.floats(2.0, 12.0), st.floats(-2.0, 2.0), st.floats(-0.2, 0.2), st.floats(0.6, 1.6))
def test_a_box_is_where_the_other_camera_sees_the_same_person(
    ahead_m: float, left_m: float, aside_m: float, height_m: float
) -> None:
    here, there = calibration(), calibration(aside_m, height_m, 250.0)
    found = carried_over(seen(here, ahead_m, left_m)[None], Viewpoint.of(here, SHAPE), here, there)
    np.testing.assert_allclose(found[0], seen(there, ahead_m, left_m), atol=1e-6)


def test_the_camera_itself_sees_the_same() -> None:
    here = calibration()
    box = np.array([[100.0, 40.0, 30.0, 120.0], [10.0, 100.0, 8.0, 40.0]])
    np.testing.assert_allclose(carried_over(box, Viewpoint.of(here, SHAPE), here, here), box, atol=1e-9)


def test_whom_the_other_camera_cannot_see_has_no_box() -> None:
    here, pose = calibration(), calibration().robot_from_camera.copy()
    pose[:3, :3] = pose[:3, :3] @ np.diag([-1.0, 1.0, -1.0])  # looks back
    behind = PinholeCalibration(here.intrinsics, pose)
    found = carried_over(seen(here, 4.0, 0.0)[None], Viewpoint.of(here, SHAPE), here, behind)
    assert not found.any()
