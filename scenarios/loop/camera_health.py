"""Judge from its images whether a camera works or is black, saturated, constant, frozen or silent."""

from collections.abc import Mapping
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.cameras.camera_config import CameraConfig, ThermalConfig
from peopleboy.sim.observation import Observation
from peopleboy.sim.world_config import CONTROL_HZ

Image = NDArray[Any]

FLAT: Final = 2  # a failed sensor still flickers by a grey level or two
_MIDDLE: Final = (
    0.2  # share of the width on either side that a fast turn takes out of view between two images
)
# What fills less of the image, or is narrower, may leave it in one step: behind the edge of a wall or a door.
_TALL: Final = 0.2  # [image heights]
_WIDE: Final = 0.1  # share of the square of its height that a pattern fills; 0.17 for a person who stands
_NOISY_PX: Final = 50  # so many noisy pixels, counted over consecutive images, do not repeat by chance
_CARRIED_M: Final = 0.3  # a median change of the sonar ranges within a frame that driving does not explain
_LATE_S: Final = 0.1  # a frame more than the shutter's time

# Cameras with images that may be uniform: a view colder than the span, or beyond a camera's reach.
_MAY_BE_FLAT: Final = frozenset({"thermal", "depth"})


class CameraHealth:
    """Watches the images of cameras, instant by instant.

    A colour image without dynamic range is a failure. A thermal image without it is one only if another
    camera fails at the same time, or if something was in the middle of the last image that cannot have left
    it since: a view colder than the thermal camera's span has no noise, and is uniform. Camera noise never
    repeats, so an image that equals the last one is a failure as well, but for the time of a shutter. If most
    sonar ranges jump at the same time, the robot was carried, and anything may have left the view.

    Args:
        cameras: settings of the robot's cameras, by name.
        watched: names of those to watch; the others are not rendered.

    Attributes:
        only_repeats: whether the images of the last instant repeat earlier ones; uniform ones do not count.
    """

    def __init__(self, cameras: Mapping[str, CameraConfig], watched: tuple[str, ...]) -> None:
        self._cameras = cameras
        self._watched = watched
        self._last: dict[str, tuple[Image, float]] = {}  # the last image that was new, and its time
        self._dead: dict[str, Image] = {}  # first image without dynamic range of each camera that has failed
        self._same_px: dict[str, int] = {}  # noisy pixels that have repeated since the last new image
        self._failed: set[str] = set()
        self._sonar_m: Image = np.zeros(0)
        self.only_repeats = False

    def check(self, observation: Observation) -> dict[str, str]:
        """Return what is wrong with each camera that has failed at this instant; empty if all work."""
        images, time_s = observation.images, observation.time_s
        faults: dict[str, str] = {}
        flat: dict[str, Image] = {}
        repeated: set[str] = set()
        for name in self._watched:
            image = images.get(name)
            if image is None:
                if name in self._last and self._periods(name, time_s) > 0.9:
                    faults[name] = "no image"
            elif _is_flat(image):
                flat[name] = image
            elif self._is_repeated(name, image):
                repeated.add(name)
                if time_s - self._last[name][1] > self._shutter_s(name):
                    faults[name] = "the image repeats"
            else:
                self._last[name] = image, time_s
        self.only_repeats = bool(repeated) and repeated | flat.keys() >= images.keys() & set(self._watched)
        # Whatever made several cameras fail has ended if one of them works again.
        may_be_cold = self._is_carried(observation.sonar_m) or bool(
            self._failed & images.keys() - flat.keys() - faults.keys()
        )
        dead = {
            name
            for name, image in flat.items()
            if not (may_be_cold and self._may_be_flat(name)) and self._is_dead(name, image, time_s)
        }
        self._dead = {name: self._dead.get(name, flat[name]) for name in dead}
        for name, image in flat.items():
            if dead:
                faults[name] = _describe(image)
            if name not in dead:
                self._last[name] = image, time_s
        self._failed = set(faults)
        return faults

    def _is_carried(self, sonar_m: Image) -> bool:
        before, self._sonar_m = self._sonar_m, sonar_m
        return before.shape == sonar_m.shape and bool(np.median(np.abs(sonar_m - before)) > _CARRIED_M)

    def _is_repeated(self, name: str, image: Image) -> bool:
        """Return whether a camera repeats its image; a few noisy pixels must do so several times.

        The noise of a pixel does not show in its extremes, and a camera without noise may repeat its image.
        """
        if not (self._cameras[name].is_noisy and name in self._last):
            return False
        if not np.array_equal(self._last[name][0], image):
            self._same_px[name] = 0
            return False
        noisy_px = int(np.count_nonzero((image > image.min()) & (image < image.max())))
        self._same_px[name] = self._same_px.get(name, 0) + noisy_px
        return self._same_px[name] >= _NOISY_PX

    def _is_dead(self, name: str, image: Image, time_s: float) -> bool:
        """Return whether an image without dynamic range is a failure by itself."""
        if name not in self._dead:
            return self._cannot_be_flat(name, time_s)
        # A dead sensor flickers; a cold view after it does not.
        is_steady = image.max() == image.min()
        return not (self._may_be_flat(name) and is_steady and not np.array_equal(image, self._dead[name]))

    def _cannot_be_flat(self, name: str, time_s: float) -> bool:
        if not self._may_be_flat(name):
            return True
        # After a gap, whatever was in the last image may have left.
        return name in self._last and self._periods(name, time_s) < 1.5 and _has_pattern(self._last[name][0])

    def _may_be_flat(self, name: str) -> bool:
        return self._cameras[name].kind in _MAY_BE_FLAT

    def _periods(self, name: str, time_s: float) -> float:
        """Return the time since a camera's last new image, in periods of its frame rate."""
        return (time_s - self._last[name][1]) * (self._cameras[name].rate_hz or CONTROL_HZ)

    def _shutter_s(self, name: str) -> float:
        """Return for how long [s] a camera may repeat its image."""
        camera = self._cameras[name]
        if not isinstance(camera, ThermalConfig) or camera.shutter_every_s == 0.0:
            return 0.0
        return camera.shutter_lasts_s + _LATE_S


def _is_flat(image: Image) -> bool:
    return int(image.max()) - int(image.min()) <= FLAT


def _has_pattern(image: Image) -> bool:
    """Return whether something in the middle of an image is so large that it cannot leave within one step."""
    height, width = image.shape[:2]
    edge = int(_MIDDLE * width)
    middle = image[:, edge : width - edge]
    is_apart = np.abs(middle.astype(np.int32) - int(np.median(image))) > FLAT
    _, _, stats, _ = cv2.connectedComponentsWithStats(is_apart.astype(np.uint8))
    tall, area_px = stats[1:, cv2.CC_STAT_HEIGHT], stats[1:, cv2.CC_STAT_AREA]
    return bool(np.any((tall >= _TALL * height) & (area_px >= _WIDE * tall**2)))


def _describe(image: Image) -> str:
    if image.max() <= FLAT:
        return "the image is black"
    return (
        "the image is saturated"
        if image.min() >= np.iinfo(image.dtype).max - FLAT
        else "the image is constant"
    )
