"""The cameras of many worlds: images rendered by threads ahead of time or on demand."""

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.batch.drive import JoinedWorlds
from peopleboy.sim.batch.image_kernels import Array, Poses, join_scenes
from peopleboy.sim.batch.render_stages import Images, has_stage, make_stage
from peopleboy.sim.cameras.camera_config import CameraConfig, ColourConfig, ThermalConfig
from peopleboy.sim.cameras.kinds import image_names, kind_of, name_images
from peopleboy.sim.observation import OnDemand
from peopleboy.sim.physics.kinematic import turn_wheels
from peopleboy.sim.shapes.shape_table import Numbers
from peopleboy.sim.world import SimulatedWorld

Task = Callable[[], None]


class WorkerPool:
    """A pool of threads, which includes the calling one.

    Args:
        threads: 1 or more; None for as many as there are processors that this process may run on.
    """

    def __init__(self, threads: int | None = None) -> None:
        self.threads = _processors() if threads is None else threads
        self._pool = ThreadPoolExecutor(self.threads - 1) if self.threads > 1 else None

    def start(self, tasks: Sequence[Task]) -> "PendingWork":
        """Start independent tasks; they are done when `PendingWork.finish` returns."""
        return PendingWork(
            [(task, None if self._pool is None else self._pool.submit(task)) for task in tasks]
        )

    def close(self) -> None:
        """Stop the threads."""
        if self._pool is not None:
            self._pool.shutdown()


class PendingWork:
    """Tasks in progress."""

    def __init__(self, tasks: Sequence[tuple[Task, Future[None] | None]]) -> None:
        self._tasks = list(tasks)

    def finish(self) -> None:
        """Do the tasks that no thread has started, the last first, and wait for the others."""
        begun = []
        while self._tasks:
            task, future = self._tasks.pop()
            if future is None or future.cancel():
                task()
            else:
                begun.append(future)
        for future in begun:
            future.result()


def _processors() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


Start = Callable[[], tuple[Images, PendingWork]]


class Exposure:
    """Images of one camera at an instant in some of G worlds.

    Args:
        name: of the camera.
        config: its settings, the same in all worlds.
        rows: which of the worlds, in the order of the images.
        start: gives space for the images, and who fills it; called once at most.
    """

    def __init__(self, name: str, config: CameraConfig, rows: Sequence[int], start: Start) -> None:
        self.name, self.rows = name, rows
        self._config, self._start = config, start
        self._begun: tuple[Images, PendingWork] | None = None
        self._is_over = False
        self.is_asked_for = False

    def begin(self) -> tuple[Images, PendingWork]:
        """Start rendering.

        Raises:
            BadInput: the instant is over, and had not begun them.
        """
        if self._begun is None:
            if self._is_over:
                raise BadInput(
                    f"camera {self.name!r}: the image of an earlier instant was not read in "
                    "time; read it before the next step or observation"
                )
            self._begun = self._start()
        return self._begun

    def end(self) -> None:
        """Wait for started work, and prevent further rendering."""
        self._is_over = True
        if self._begun is not None:
            self._begun[1].finish()

    def images(self) -> NDArray[Any]:
        """Return the camera's first layer for all of its worlds."""
        return self._finish()[0]

    def image(self, name: str, place: int) -> NDArray[Any]:
        """Return one image by name, for the world at an index among the camera's worlds."""
        images = self._finish()
        if name == self.name:
            return np.asarray(images[0][place])
        return name_images(self.name, self._config, [each[place] for each in images])[name]

    def _finish(self) -> Images:
        self.is_asked_for = True
        images, work = self.begin()
        work.finish()
        return images


class Exposures:
    """All images of an instant.

    Args:
        shots: of each camera that is due anywhere.
        names: of the images of each camera.
    """

    def __init__(self, shots: Sequence[Exposure], names: Mapping[str, Sequence[str]]) -> None:
        self._shots, self._names = tuple(shots), names

    @classmethod
    def none(cls) -> "Exposures":
        """Return an empty set of images."""
        return cls((), {})

    def asked_for(self) -> set[str]:
        """Return the names of the cameras whose images were read."""
        return {shot.name for shot in self._shots if shot.is_asked_for}

    def end(self) -> None:
        """Wait for started work; call it before the worlds change."""
        for shot in self._shots:
            shot.end()

    def of_world(self, row: int) -> Mapping[str, NDArray[Any]]:
        """Return the images of one of the worlds by their names."""
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

    def of_camera(self, camera: str) -> tuple[Sequence[int], Sequence[NDArray[Any]] | NDArray[Any]]:
        """Return the worlds in which a camera takes an image, and the images of its first layer."""
        return next(((shot.rows, shot.images()) for shot in self._shots if shot.name == camera), ((), ()))


_SHARES: Final = 2  # of a camera's images for each thread, so that none waits long for the last


class BatchCameras:
    """The cameras of B worlds, see `shared_cameras`; with the same bytes as those of each world by itself.

    Images of a camera are made ahead, by threads while Python goes on, if those were asked for of the
    instant before; all others when they are asked for.

    Args:
        worlds: of one kind, all of a batch.
        joined: where all of their parts are.
        wheels: (B, 2) numbers of the wheels among the parts of all worlds.
        workers: makes the images.
    """

    def __init__(
        self, worlds: Sequence[SimulatedWorld], joined: JoinedWorlds, wheels: Numbers, workers: WorkerPool
    ) -> None:
        self._worlds, self._joined, self._crew = tuple(worlds), joined, workers
        self._wheels = wheels.reshape(-1)
        self._cameras = dict(worlds[0].cameras)
        scene = join_scenes([world.table for world in worlds], [world.materials for world in worlds])
        self._stages = {
            name: make_stage(name, config, scene, worlds) for name, config in self._cameras.items()
        }
        self._images = {name: image_names(name, config) for name, config in self._cameras.items()}
        first_body = np.repeat(joined.first_body[:-1], np.diff(joined.first_part))
        self._body_of_part = joined.bodies.of_part + first_body
        self._is_clear = np.concatenate([world.is_clear for world in worlds])
        self._shots = Exposures.none()

    def look(self, active: Numbers, robots: Array, turn_rad_s: Array) -> Exposures:
        """Take the images of some worlds at this instant.

        Args:
            active: (G,) numbers of the worlds.
            robots: (G, 4, 4) world from robot.
            turn_rad_s: (G,) at which they turn.
        """
        asked_for = self._shots.asked_for()
        self.finish()
        part = self._joined.bodies.poses.copy()
        turn_wheels(part, self._wheels, self._joined.motion.angles.reshape(-1))
        hidden = self._joined.bodies.hidden[self._body_of_part]
        due = [self._worlds[number].await_images() for number in active.tolist()]
        shots = []
        for name, config in self._cameras.items():
            rows = [row for row, names in enumerate(due) if name in names]
            if rows:
                assert isinstance(config, ThermalConfig | ColourConfig)
                poses = Poses(
                    part=part,
                    hidden=hidden if kind_of(config).senses_heat else hidden | self._is_clear,
                    camera=robots[rows] @ config.camera.robot_from_camera,
                    turned=turn_rad_s[rows] * config.exposure_s,
                )
                shots.append(Exposure(name, config, rows, partial(self._render, name, active[rows], poses)))
        for shot in reversed(shots):  # the reader of the first image helps to render it
            if shot.name in asked_for:
                shot.begin()
        self._shots = Exposures(shots, self._images)
        return self._shots

    def finish(self) -> None:
        """Wait for all images in progress; call it before the worlds change."""
        self._shots.end()

    def _render(self, name: str, worlds: Numbers, poses: Poses) -> tuple[Images, PendingWork]:
        images, fill = self._stages[name].render(worlds, poses)
        count = min(_SHARES * self._crew.threads, len(worlds))
        ends = np.linspace(0, len(worlds), count + 1).round().astype(int).tolist()
        return images, self._crew.start([partial(fill, *share) for share in pairwise(ends)])


def shared_cameras(world: SimulatedWorld) -> tuple[tuple[str, CameraConfig], ...] | None:
    """Return the key shared by worlds that are rendered together; None for a world that renders alone."""
    config = world.config
    if config.renderer != "raycast" or config.detail != "plain" or config.body_shape != "capsules":
        return None
    return tuple(world.cameras.items()) if all(map(has_stage, world.cameras.values())) else None
