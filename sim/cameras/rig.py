"""All cameras of a robot: which are due at an instant, and images that are rendered on demand."""

from collections.abc import Callable, Mapping
from functools import partial

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.imaging.camera_view import CameraView
from peopleboy.sim.cameras.kinds import image_names, kind_of, name_images
from peopleboy.sim.cameras.sensors import Image, Sensor
from peopleboy.sim.observation import OnDemand


class Rig:
    """Takes the images of a robot's cameras.

    Each camera has its own noise streams, and the noise of unread images is skipped; a camera whose images
    depend on earlier ones renders every image at once. The content of an image therefore depends neither on
    the other cameras nor on which images were read before.

    Args:
        cameras: settings of the cameras by name.
        control_hz: [Hz] control rate.
        seed: seed of all noise.
        look: returns the current view of a camera with the given settings.
    """

    def __init__(
        self,
        cameras: Mapping[str, CameraConfig],
        control_hz: int,
        seed: int,
        look: Callable[[CameraConfig], CameraView],
    ) -> None:
        self._cameras, self._look = cameras, look
        self._sensors = {name: kind_of(one).sensor(one, name, seed) for name, one in cameras.items()}
        self._every = {name: control_hz // (one.rate_hz or control_hz) for name, one in cameras.items()}
        self._unread = dict.fromkeys(cameras, 0)
        self._reading = 0

    def due(self, tick: int) -> tuple[str, ...]:
        """Return the names of the cameras that take an image at an instant, counted in control steps."""
        return tuple(name for name, every in self._every.items() if tick % every == 0)

    def read(self, tick: int) -> Mapping[str, Image]:
        """Return the images of the cameras that are due, rendered on first access until the next call.

        Cameras whose images depend on earlier ones render at once.

        Raises:
            BadInput: an image is read after the next call.
        """
        due = self.expect(tick)
        shots = OnDemand(due, partial(self._shoot, self._reading))
        for name in due:
            if self._cameras[name].remembers:
                shots[name]
        owner = {image: name for name in due for image in image_names(name, self._cameras[name])}
        return OnDemand(owner, lambda image: shots[owner[image]][image])

    def expect(self, tick: int) -> tuple[str, ...]:
        """Return the names of the due cameras, whose sensors can be taken over until the next call."""
        self.forget()
        due = self.due(tick)
        for name in due:
            self._unread[name] += 1
        return due

    def sensor(self, name: str) -> Sensor:
        """Return the sensor of a camera, for a caller that reads its settings and takes no image."""
        return self._sensors[name]

    def take_over(self, name: str) -> Sensor:
        """Return the sensor of a camera, for a caller that renders its image of this instant."""
        sensor = self._sensors[name]
        for _ in range(self._unread[name] - 1):
            sensor.skip()
        self._unread[name] = 0
        return sensor

    def forget(self) -> None:
        """Invalidate the images of the last reading."""
        self._reading += 1

    def _shoot(self, reading: int, name: str) -> Mapping[str, Image]:
        if reading != self._reading:
            raise BadInput(
                f"camera {name!r}: the image of an earlier instant was not read in time; "
                "read it before the next step or observation"
            )
        config = self._cameras[name]
        return name_images(name, config, self.take_over(name).take(self._look(config)))
