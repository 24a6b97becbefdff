"""Correction of lens distortion by a calibration file of OpenCV or ROS."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
import yaml
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.user_files import read_text

Floats = NDArray[np.float32]

_MATRIX_TAG: Final = "tag:yaml.org,2002:opencv-matrix"
_FISHEYE: Final = ("equidistant", "fisheye")
_COUNTS: Final = (4, 5, 8, 12, 14)
"""Numbers of coefficients of OpenCV's standard model; four of them are also a fisheye lens."""


@dataclass(frozen=True, slots=True, eq=False)
class Lens:
    """Intrinsics and distortion of a camera.

    Attributes:
        size: width and height of its images [px].
        matrix: (3, 3) camera matrix.
        distortion: (K,) coefficients.
        is_fisheye: whether they are those of OpenCV's fisheye model.
    """

    size: tuple[int, int]
    matrix: NDArray[np.float64]
    distortion: NDArray[np.float64]
    is_fisheye: bool = False
    _maps: tuple[Any, Any] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Compute where each pixel of an undistorted image is in the original."""
        fisheye = cv2.fisheye.initUndistortRectifyMap
        make = fisheye if self.is_fisheye else cv2.initUndistortRectifyMap
        straight = self._straight_matrix()
        maps = make(self.matrix, self.distortion, np.eye(3), straight, self.size, cv2.CV_16SC2)
        object.__setattr__(self, "_maps", maps)

    @property
    def focal_px(self) -> float:
        """Focal length of undistorted images [px]."""
        return float(self.matrix[1, 1])

    def undistort(self, image: Floats) -> Floats:
        """Return an image (H, W) without distortion, with square pixels and the optical axis in its middle.

        Raises:
            BadInput: the image has another size than the calibration.
        """
        if (image.shape[1], image.shape[0]) != self.size:
            width, height = self.size
            raise BadInput(
                f"--calibration: is for images of {width}x{height}, got {image.shape[1]}x{image.shape[0]}"
            )
        maps = self._maps
        straight = cv2.remap(image, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(straight, np.float32)

    def _straight_matrix(self) -> NDArray[np.float64]:
        width, height = self.size
        focal = self.focal_px
        return np.array([[focal, 0.0, (width - 1) / 2], [0.0, focal, (height - 1) / 2], [0.0, 0.0, 1.0]])


class _Loader(yaml.SafeLoader):
    """Reads YAML with OpenCV's matrices."""


def _construct_matrix(loader: yaml.SafeLoader, node: yaml.MappingNode) -> dict[Any, Any]:
    return loader.construct_mapping(node, deep=True)


_Loader.add_constructor(_MATRIX_TAG, _construct_matrix)


def read_lens(path: Path) -> Lens:
    """Read `image_width`, `image_height`, `camera_matrix` and `distortion_coefficients` from a YAML file.

    Raises:
        BadInput: the file cannot be read, lacks one of them, or has an unknown distortion model.
    """
    try:
        text = read_text(path)
        content = yaml.load(text.removeprefix("%YAML:1.0"), _Loader)  # which is not YAML's directive
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise BadInput(
            f"{path}: cannot be read as a calibration; give a YAML file of OpenCV or ROS"
        ) from error
    values = content if isinstance(content, dict) else {}
    size = tuple(_numbers(path, values, name, 1)[0] for name in ("image_width", "image_height"))
    matrix = _numbers(path, values, "camera_matrix", 9).reshape(3, 3)
    distortion = _numbers(path, values, "distortion_coefficients")
    is_fisheye = str(values.get("distortion_model", "")).lower() in _FISHEYE
    if len(distortion) not in (_COUNTS[:1] if is_fisheye else _COUNTS):
        raise BadInput(
            f"{path}: distortion_coefficients: must be {', '.join(map(str, _COUNTS))} numbers, or 4 of a "
            f"fisheye lens, got {len(distortion)}"
        )
    if not (min(size) >= 1 and min(matrix[0, 0], matrix[1, 1]) > 0.0):
        raise BadInput(f"{path}: size and focal lengths must be above 0")
    return Lens((int(size[0]), int(size[1])), matrix, distortion, is_fisheye)


def _numbers(path: Path, values: dict[str, Any], name: str, count: int | None = None) -> NDArray[np.float64]:
    """Return the finite numbers of a matrix, a list or a scalar."""
    found = values.get(name)
    found = found.get("data") if isinstance(found, dict) else found
    flat = list(_flat(found))
    if found is None or not flat or (count is not None and len(flat) != count):
        wanted = "a list of numbers" if count is None else "a number" if count == 1 else f"{count} numbers"
        raise BadInput(f"{path}: {name}: must be {wanted}")
    try:
        numbers = np.array([float(each) for each in flat])
    except (TypeError, ValueError):
        numbers = np.array([math.nan])
    if not np.isfinite(numbers).all():
        raise BadInput(f"{path}: {name}: must be finite numbers")
    return numbers


def _flat(values: Any) -> list[Any]:
    if not isinstance(values, list):
        return [values]
    return [each for value in values for each in _flat(value)]
