import cv2
import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.lens import Lens, read_lens

SIZE = (160, 120)
MATRIX = np.array([[150.0, 0.0, 85.0], [0.0, 140.0, 57.0], [0.0, 0.0, 1.0]])
DISTORTION = np.array([-0.3, 0.08, 0.001, -0.002, 0.0])


def write_opencv(path, **changes):
    values = {"image_width": 160, "image_height": 120, "camera_matrix": MATRIX} | changes
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for name, value in ({"distortion_coefficients": DISTORTION} | values).items():
        file.write(name, value)
    file.release()
    return path


def test_a_point_lands_where_the_ideal_camera_sees_it():
    lens = Lens(SIZE, MATRIX, DISTORTION)
    ray = np.array([[[0.3, -0.2, 1.0]]])
    at, _ = cv2.projectPoints(ray, np.zeros(3), np.zeros(3), MATRIX, DISTORTION)
    image = np.zeros(SIZE[::-1], np.float32)
    cv2.circle(image, tuple(np.rint(at[0, 0]).astype(int).tolist()), 2, 1.0, -1)
    straight = lens.undistort(image)
    rows, columns = np.nonzero(straight > 0.5)
    focal = lens.focal_px
    assert columns.mean() == pytest.approx(79.5 + 0.3 * focal, abs=1.0)
    assert rows.mean() == pytest.approx(59.5 - 0.2 * focal, abs=1.0)


def test_files_of_opencv_and_of_ros_are_the_same_lens(tmp_path):
    ros = tmp_path / "camera_info.yaml"
    ros.write_text(
        "image_width: 160\nimage_height: 120\ndistortion_model: plumb_bob\n"
        f"camera_matrix: {{rows: 3, cols: 3, data: {MATRIX.ravel().tolist()}}}\n"
        f"distortion_coefficients: {{rows: 1, cols: 5, data: {DISTORTION.tolist()}}}\n"
    )
    image = np.random.default_rng(0).random(SIZE[::-1], np.float32)
    one, other = read_lens(write_opencv(tmp_path / "camera.yml")), read_lens(ros)
    np.testing.assert_array_equal(one.undistort(image), other.undistort(image))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"camera_matrix": np.eye(2)}, "camera_matrix: must be 9 numbers"),
        ({"distortion_coefficients": np.zeros(3)}, "got 3"),
        ({"image_width": 0}, "above 0"),
        ({"camera_matrix": MATRIX * np.nan}, "finite"),
    ],
)
def test_a_file_that_is_no_calibration_is_refused(tmp_path, changes, words):
    with pytest.raises(BadInput, match=words):
        read_lens(write_opencv(tmp_path / "camera.yml", **changes))


@pytest.mark.parametrize("text", ["", "a: [", "5", "image_width: 160"])
def test_other_text_is_refused(tmp_path, text):
    (tmp_path / "camera.yml").write_text(text)
    with pytest.raises(BadInput, match=r"camera\.yml"):
        read_lens(tmp_path / "camera.yml")


def test_images_of_another_size_are_refused():
    with pytest.raises(BadInput, match="160x120, got 100x50"):
        Lens(SIZE, MATRIX, DISTORTION).undistort(np.zeros((50, 100), np.float32))
