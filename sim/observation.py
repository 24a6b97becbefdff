"""What the robot senses at one instant; the truth is never in it. Images are made on demand."""

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
    """What the robot senses at one instant without its eyes.

    Attributes:
        time_s: [s] since the start.
        sonar_m: (16,) [m].
        odometry: pose that the wheels' encoders add up to, world frame, exact at the start.
        wheel_speeds_m_s: rim speeds [m/s] of the left and right wheel.
    """

    time_s: float
    sonar_m: NDArray[np.float64]
    odometry: Pose2
    wheel_speeds_m_s: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observation(Senses):
    """All the robot's senses at one instant.

    Attributes:
        images: of the cameras that take one at this instant, by the camera's name; each is made when it is
            first asked for, which must be before the next step or observation. A thermal camera, such as
            `thermal`, gives (H, W) uint8 grey, by its gain, usually linear over 24..36 degC; as `thermal_c`
            (H, W) float32 [degC], the same before it is encoded; as `thermal_scene` (H, W) uint8, for people
            to look at; a colour camera, such as `colour`, (H, W, 3) uint8 sRGB;
            a depth camera, such as `depth`, (H, W) uint16 [mm] along the optical axis, 0 where none is read,
            and as `depth_colour` (H, W, 3) uint8 sRGB of the same pixels.
        calibrations: of the robot's cameras, by name: where each sits, and where its pixels look.
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
    """A mapping whose names are known, and whose values are made when first asked for, and then kept.

    Args:
        names: in their order.
        make: gives the value of a name.
        made: values that are there already.
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
