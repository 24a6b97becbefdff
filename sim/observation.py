"""Observations: sensor readings at one instant, without ground truth. Images are rendered on demand."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.geometry.pose2 import Pose2
from peopleboy.notebook import names_of, png_of


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Senses:
    """Readings of the robot's sensors at one instant, except cameras.

    Attributes:
        time_s: [s] since the start.
        sonar_m: (16,) [m].
        odometry: pose integrated from the wheel encoders, world frame, exact at the start.
        wheel_speeds_m_s: rim speeds [m/s] of the left and right wheel.
    """

    time_s: float
    sonar_m: NDArray[np.float64]
    odometry: Pose2
    wheel_speeds_m_s: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observation(Senses):
    """Readings of all the robot's sensors at one instant.

    Attributes:
        images: images of the cameras that take one at this instant, by name; each is rendered on first
            access, which must be before the next step or observation. A thermal camera, such as
            `thermal`, gives (H, W) uint8 grey, by its gain, usually linear over 24..36 degC; as `thermal_c`
            (H, W) float32 [degC], the same before it is encoded; as `thermal_scene` (H, W) uint8, for
            display; a colour camera, such as `colour`, (H, W, 3) uint8 sRGB;
            a depth camera, such as `depth`, (H, W) uint16 [mm] along the optical axis, 0 for no reading,
            and as `depth_colour` (H, W, 3) uint8 sRGB of the same pixels.
        calibrations: calibrations of the robot's cameras by name: mounting pose and ray of each pixel.
    """

    images: Mapping[str, NDArray[Any]]
    calibrations: Mapping[str, Calibration] = field(default_factory=dict)

    def __repr__(self) -> str:
        """Name the images, which may not have been rendered yet."""
        return f"Observation(time_s={self.time_s:.3f}, images: {names_of(self.images)})"

    def _repr_png_(self) -> bytes | None:
        return png_of(self.images)


V = TypeVar("V")


class OnDemand(Mapping[str, V]):
    """A mapping with known names, whose values are computed on first access and then kept.

    Args:
        names: the names in order.
        make: computes the value of a name.
        made: values that exist already.
    """

    def __init__(
        self, names: Iterable[str], make: Callable[[str], V], made: Mapping[str, V] | None = None
    ) -> None:
        self._names = dict.fromkeys(names)
        self._make = make
        self._made: dict[str, V] = {} if made is None else dict(made)

    def __getitem__(self, name: str) -> V:
        if name not in self._names:
            raise KeyError(name)
        if name not in self._made:
            self._made[name] = self._make(name)
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)
