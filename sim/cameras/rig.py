"""All cameras of a robot at work: which are due at an instant, and images that are made when asked for."""

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

    A camera's noise is its own, and that of an image that nobody asks for goes by; a camera that remembers
    takes all of its images at once. What an image holds depends therefore neither on the other cameras nor
    on which images were asked for before.

    Args:
        cameras: settings by name.
        control_hz: [Hz] of instants.
        seed: of all noise.
        look: gives what a camera of some settings sees now.
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
        """Name the cameras that take an image at an instant, counted in control steps."""
        return tuple(name for name, every in self._every.items() if tick % every == 0)

    def read(self, tick: int) -> Mapping[str, Image]:
        """Return the images of the cameras that are due, each made when first asked for, until the next call.

        One of a camera that remembers is made now.

        Raises:
            BadInput: when one is asked for later.
        """
        due = self.expect(tick)
        shots = OnDemand(due, partial(self._shoot, self._reading))
        for name in due:
            if self._cameras[name].remembers:
                shots[name]
        owner = {image: name for name in due for image in image_names(name, self._cameras[name])}
        return OnDemand(owner, lambda image: shots[owner[image]][image])

    def expect(self, tick: int) -> tuple[str, ...]:
        """Name the cameras that are due, of which a person may take the image until the next call."""
        self.forget()
        due = self.due(tick)
        for name in due:
            self._unread[name] += 1
        return due

    def take_over(self, name: str) -> Sensor:
        """Return the sensor of a camera to who takes its image of this instant now."""
        sensor = self._sensors[name]
        for _ in range(self._unread[name] - 1):
            sensor.skip()
        self._unread[name] = 0
        return sensor

    def forget(self) -> None:
        """Let nobody ask any more for images of the last reading."""
        self._reading += 1

    def _shoot(self, reading: int, name: str) -> Mapping[str, Image]:
        if reading != self._reading:
            raise BadInput(
                f"camera {name!r}: the image of an instant that is over was not asked for while it lasted; "
                "read it before the next step or observation"
            )
        config = self._cameras[name]
        return name_images(name, config, self.take_over(name).take(self._look(config)))
