"""The images of one instant in many worlds: made ahead, or when somebody asks for one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import name_images
from peopleboy.sim.fleet.crew import Work
from peopleboy.sim.fleet.drawing.studios import Images
from peopleboy.sim.on_demand import OnDemand

Start = Callable[[], tuple[Images, Work]]


class Shot:
    """What one camera takes at an instant in some of G worlds.

    Args:
        name: of the camera.
        config: its settings, the same in all worlds.
        rows: which of the worlds, in the order of the images.
        start: gives space for the images, and who fills it; called once at most.
    """

    def __init__(self, name: str, config: CameraConfig, rows: Sequence[int], start: Start) -> None:
        self.name, self.rows = name, rows
        self._config, self._start = config, start
        self._begun: tuple[Images, Work] | None = None
        self._is_over = False
        self.is_asked_for = False

    def begin(self) -> tuple[Images, Work]:
        """Have the images made.

        Raises:
            BadInput: the instant is over, and nobody had begun with them.
        """
        if self._begun is None:
            if self._is_over:
                raise BadInput(
                    f"camera {self.name!r}: the image of an instant that is over was not asked for while it "
                    "lasted; read it before the next step or observation"
                )
            self._begun = self._start()
        return self._begun

    def end(self) -> None:
        """Wait for what has begun; nothing else can begin any more."""
        self._is_over = True
        if self._begun is not None:
            self._begun[1].finish()

    def images(self) -> NDArray[Any]:
        """Give those of the camera's own name, of all of its worlds."""
        return self._finish()[0]

    def image(self, name: str, place: int) -> NDArray[Any]:
        """Give an image of that name, of the world at some place among its own."""
        images = self._finish()
        if name == self.name:
            return np.asarray(images[0][place])
        return name_images(self.name, self._config, [each[place] for each in images])[name]

    def _finish(self) -> Images:
        self.is_asked_for = True
        images, work = self.begin()
        work.finish()
        return images


class Shots:
    """All of an instant.

    Args:
        shots: of each camera that is due anywhere.
        names: of the images of each camera.
    """

    def __init__(self, shots: Sequence[Shot], names: Mapping[str, Sequence[str]]) -> None:
        self._shots, self._names = tuple(shots), names

    @classmethod
    def none(cls) -> Shots:
        """Those of no instant yet."""
        return cls((), {})

    def asked_for(self) -> set[str]:
        """Names of the cameras of which somebody asked for an image."""
        return {shot.name for shot in self._shots if shot.is_asked_for}

    def end(self) -> None:
        """Wait for what has begun, as must be before anything in the worlds changes."""
        for shot in self._shots:
            shot.end()

    def of(self, row: int) -> Mapping[str, NDArray[Any]]:
        """Give the images of one of the worlds by their names."""
        owners = {
            image: (shot, shot.rows.index(row))
            for shot in self._shots
            if row in shot.rows
            for image in self._names[shot.name]
        }

        def make(image: str) -> NDArray[Any]:
            shot, place = owners[image]
            return shot.image(image, place)

        return OnDemand(owners, make)

    def together(self, camera: str) -> tuple[Sequence[int], Sequence[NDArray[Any]] | NDArray[Any]]:
        """Give the images of a camera's own name: in which of the worlds it takes one, and these."""
        return next(((shot.rows, shot.images()) for shot in self._shots if shot.name == camera), ((), ()))
