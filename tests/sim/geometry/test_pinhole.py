import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.sim.cameras.camera_config import COLOUR_ZOOM, ColourConfig, ThermalConfig
from peopleboy.sim.geometry.pinhole import Pinhole, invert_pose, transform

cameras = st.builds(
    Pinhole,
    width=st.integers(8, 640),
    height=st.integers(8, 480),
    vertical_fov_rad=st.floats(0.2, 2.0),
    pitch_rad=st.floats(-1.0, 1.0),
    yaw_rad=st.floats(-3.0, 3.0),
)


@given(camera=cameras, u=st.floats(-100, 800), v=st.floats(-100, 600), z=st.floats(0.1, 50.0))
def test_a_pixel_at_a_depth_projects_back_to_itself(camera: Pinhole, u: float, v: float, z: float) -> None:
    point = z * np.linalg.inv(camera.intrinsics) @ [u, v, 1.0]
    assert camera.project(point) == pytest.approx([u, v], abs=1e-6)


@given(camera=cameras)
def test_the_field_of_view_ends_at_the_image_s_edges(camera: Pinhole) -> None:
    half = camera.vertical_fov_rad / 2.0
    edges = np.array([[0.0, side * math.tan(half), 1.0] for side in (-1.0, 1.0)])
    assert camera.project(edges)[:, 1] == pytest.approx([-0.5, camera.height - 0.5])


@given(camera=cameras)
def test_its_pose_is_a_rotation_that_undoes_itself(camera: Pinhole) -> None:
    pose = camera.robot_from_camera
    assert pose[:3, :3] @ pose[:3, :3].T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)
    assert pose @ invert_pose(pose) == pytest.approx(np.eye(4), abs=1e-12)


def pixel(camera: Pinhole, *robot_point: float) -> tuple[float, float]:
    u, v = camera.project(transform(invert_pose(camera.robot_from_camera), np.array(robot_point)))
    return float(u), float(v)


def test_what_is_left_of_the_robot_is_left_in_the_image_and_what_is_high_is_up() -> None:
    camera = Pinhole()
    u, v = camera.centre_px
    assert pixel(camera, 4.0, 1.0, 1.2)[0] < u < pixel(camera, 4.0, -1.0, 1.2)[0]
    assert pixel(camera, 4.0, 0.0, 1.8)[1] < v < pixel(camera, 4.0, 0.0, 0.5)[1]


@given(x=st.floats(1.0, 1000.0), y=st.floats(-0.5, 0.5))
def test_the_horizon_of_a_level_camera_is_its_middle_row(x: float, y: float) -> None:
    camera = Pinhole()
    assert pixel(camera, x, x * y, camera.position_m[2])[1] == pytest.approx(camera.centre_px[1])


def test_looking_down_moves_things_up_and_looking_left_moves_them_right() -> None:
    ahead = (5.0, 0.0, 1.2)
    u, v = Pinhole().centre_px
    assert pixel(Pinhole(pitch_rad=0.1), *ahead)[1] < v - 10.0
    assert pixel(Pinhole(yaw_rad=0.1), *ahead)[0] > u + 10.0


def test_points_behind_the_camera_have_no_pixel() -> None:
    assert np.isnan(Pinhole().project(np.array([[0.0, 0.0, -1.0], [1.0, 1.0, 0.0]]))).all()


def test_the_colour_camera_is_narrower_by_the_sources_zoom_and_beside_the_thermal_one() -> None:
    thermal, colour = ThermalConfig().camera, ColourConfig().camera
    assert colour.focal_px / thermal.focal_px == pytest.approx(COLOUR_ZOOM)
    assert np.subtract(colour.position_m, thermal.position_m) == pytest.approx([0.0, 0.06, 0.0])


def test_a_standing_person_is_whole_from_3_m_on() -> None:
    camera = Pinhole()
    for height in (0.0, 1.9):
        assert -0.5 <= pixel(camera, camera.position_m[0] + 3.0, 0.0, height)[1] <= camera.height - 0.5
