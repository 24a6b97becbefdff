"""The cameras of many worlds, whose images are made together."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from typing import Final

import numpy as np

from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import image_names
from peopleboy.sim.fleet.crew import Crew, Work
from peopleboy.sim.fleet.drawing.look_worlds import Poses
from peopleboy.sim.fleet.drawing.scenery import Array, join_scenery
from peopleboy.sim.fleet.drawing.shots import Shot, Shots
from peopleboy.sim.fleet.drawing.studios import Images, is_simple, open_studio
from peopleboy.sim.fleet.side_by_side import Joined
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.physics.kinematic import turn_wheels
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.sim.world import World

_SHARES: Final = 2  # of a camera's images for each thread, so that none waits long for the last


class Eyes:
    """The cameras of B worlds, see `cameras_of`; they give to the byte what each world by itself would give.

    Images of a camera are made ahead, by threads while Python goes on, if somebody asked for those of the
    instant before; all others when they are asked for.

    Args:
        worlds: of one kind, all of a fleet.
        joined: where all of their parts are.
        wheels: (B, 2) numbers of the wheels among the parts of all worlds.
        crew: makes the images.
    """

    def __init__(self, worlds: Sequence[World], joined: Joined, wheels: Numbers, crew: Crew) -> None:
        self._worlds, self._joined, self._crew = tuple(worlds), joined, crew
        self._wheels = wheels.reshape(-1)
        self._cameras = dict(worlds[0].cameras)
        scenery = join_scenery([world.table for world in worlds], [world.looks for world in worlds])
        self._studios = {
            name: open_studio(name, config, scenery, worlds) for name, config in self._cameras.items()
        }
        self._images = {name: image_names(name, config) for name, config in self._cameras.items()}
        first_body = np.repeat(joined.first_body[:-1], np.diff(joined.first_part))
        self._body_of_part = joined.bodies.of_part + first_body
        self._shots = Shots.none()

    def look(self, going: Numbers, robots: Array, turn_rad_s: Array) -> Shots:
        """Take the images of some worlds at this instant.

        Args:
            going: (G,) numbers of the worlds.
            robots: (G, 4, 4) world from robot.
            turn_rad_s: (G,) at which they turn.
        """
        asked_for = self._shots.asked_for()
        self.finish()
        part = self._joined.bodies.poses.copy()
        turn_wheels(part, self._wheels, self._joined.motion.angles.reshape(-1))
        hidden = self._joined.bodies.hidden[self._body_of_part]
        due = [self._worlds[number].await_images() for number in going.tolist()]
        shots = []
        for name, config in self._cameras.items():
            rows = [row for row, names in enumerate(due) if name in names]
            if rows:
                assert isinstance(config.camera, Pinhole)
                poses = Poses(
                    part=part,
                    hidden=hidden,
                    camera=robots[rows] @ config.camera.robot_from_camera,
                    turned=turn_rad_s[rows] * config.exposure_s,
                )
                shots.append(Shot(name, config, rows, partial(self._shoot, name, going[rows], poses)))
        for shot in reversed(shots):  # as who looks at the first of them helps with that
            if shot.name in asked_for:
                shot.begin()
        self._shots = Shots(shots, self._images)
        return self._shots

    def finish(self) -> None:
        """Wait for all images with which somebody has begun, as must be before the worlds change."""
        self._shots.end()

    def _shoot(self, name: str, worlds: Numbers, poses: Poses) -> tuple[Images, Work]:
        images, fill = self._studios[name].shoot(worlds, poses)
        count = min(_SHARES * self._crew.threads, len(worlds))
        ends = np.linspace(0, len(worlds), count + 1).round().astype(int).tolist()
        return images, self._crew.start([partial(fill, *share) for share in pairwise(ends)])


def cameras_of(world: World) -> tuple[tuple[str, CameraConfig], ...] | None:
    """What all worlds must share whose images are made together; None for a world that makes its own."""
    config = world.config
    if config.renderer != "raycast" or config.detail != "plain":
        return None
    return tuple(world.cameras.items()) if all(map(is_simple, world.cameras.values())) else None
