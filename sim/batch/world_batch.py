"""Worlds stepped together: similar kinematic worlds by joint kernels, others one by one."""

import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.batch.batch_cameras import BatchCameras, WorkerPool, shared_cameras
from peopleboy.sim.batch.batch_people import BatchLimbs
from peopleboy.sim.batch.drive import BatchDrive, BatchWalks, join_worlds, refresh_worlds
from peopleboy.sim.batch.sensing import (
    BatchImages,
    BatchSonar,
    PeopleVisibility,
    SeparateImages,
    Snapshot,
    take_snapshot,
)
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.kinematic import Kinematic
from peopleboy.sim.physics.solid_shapes import Array
from peopleboy.sim.robot.robot_body import RADIUS_M, WHEEL_RADIUS_M
from peopleboy.sim.shapes.shape_table import Numbers
from peopleboy.sim.truth.scenes import SCENE, Scenes
from peopleboy.sim.world import SimulatedWorld


class KinematicBatch:
    """B worlds whose results are byte-identical to those of single worlds.

    Their state is copied into joint arrays that the worlds share, so that each world can be queried between
    steps. Robots, contacts, sonars and visibility are computed by kernels over all worlds; people walk as in
    a single world.

    Args:
        worlds: kinematic, and of one kind, see `batch_key`. A world is in one batch at a time, the last
            that it was put into.
        workers: threads that render images in the background.
    """

    def __init__(self, worlds: Sequence[SimulatedWorld], workers: WorkerPool) -> None:
        self._worlds = tuple(worlds)
        physics = [_kinematic(world) for world in worlds]
        states = [each.state() for each in physics]
        self._joined, laid = join_worlds(states)
        for each, state in zip(physics, laid, strict=True):
            each.rebind(state)
        self._own = self._joined.first_body[:-1] + self._joined.own
        self._control_s = 1.0 / worlds[0].config.control_hz
        self._walks = BatchWalks(worlds)
        self._drives = BatchDrive(worlds, self._walks, self._joined, states[0].vehicle)
        self._sonar = BatchSonar(worlds, self._joined)
        self._visibility = PeopleVisibility(worlds, self._walks, self._joined)
        self._moves_things = np.array([bool(world.config.place.movers) for world in worlds])
        self._names = [world.crowd.names for world in worlds]
        shows = worlds[0].has_images and any(self._names)
        self._limbs = BatchLimbs(worlds, self._walks, self._joined) if shows else None
        wheels = self._joined.first_part[:-1, None] + np.array([each.wheels for each in physics])
        makes_images = shared_cameras(worlds[0]) is not None
        self._eyes = BatchCameras(worlds, self._joined, wheels, workers) if makes_images else None

    def step(self, active: Numbers, commands: Array) -> None:
        """Step some of the worlds, as `SimulatedWorld.step` does.

        Args:
            active: (G,) numbers of the worlds, rising.
            commands: (G, 2) speeds [m/s, rad/s].

        Raises:
            BadInput: a command is not finite.
        """
        if self._eyes is not None:
            self._eyes.finish()
        self._drives.command(active, commands)
        before = self._walks.records.copy()
        self._walk(active, commands)
        if self._limbs is not None:
            self._limbs.place(active)
        touched = self._drives.drive(active, before["position"])
        # People who enter or leave, or who wait for the robot to make room.
        are_present = self._walks.records["is_present"]
        is_other = (are_present != before["is_present"]) | (are_present != self._drives.are_solid)
        self._end(active, touched, is_other)

    def _walk(self, active: Numbers, commands: Array) -> None:
        """Advance people."""
        for number, command in zip(active.tolist(), commands.tolist(), strict=True):
            if not self._walks.is_scripted[number]:
                self._worlds[number].begin_step(*command)
        times_s = self._times(active)
        self._walks.step(active, times_s, self._control_s, self._robots(active))
        if self._limbs is not None:
            self._limbs.move(active, times_s, self._control_s)

    def _robots(self, active: Numbers) -> Array:
        """Return (G, 5) positions, velocities and radii of the robots, as people perceive them."""
        robots = np.zeros((len(active), 5))
        robots[:, :2], robots[:, 4] = self._joined.bodies.places[self._own[active], :2], RADIUS_M
        for row in np.flatnonzero(self._walks.makes_way[active]).tolist():
            robots[row, 2:4] = self._worlds[active[row]].robot_state().velocity
        return robots

    def _end(self, active: Numbers, touched: NDArray[np.bool_], is_other: NDArray[np.bool_]) -> None:
        """Finish the step in the worlds, given the bodies touched and the people who enter or leave."""
        changes, any_touched = self._moves_things.copy(), bool(touched.any())
        changes[self._walks.world[is_other]] = True
        for number, is_changed in zip(active.tolist(), changes[active].tolist(), strict=True):
            world, names = self._worlds[number], set[str]()
            if any_touched:
                first, end = self._joined.first_body[number : number + 2]
                names = _kinematic(world).names_of(touched[first:end])
            world.end_step(names, is_settled=not is_changed)

    def look(self, active: Numbers) -> Snapshot:
        """Return readings and truth of some of the worlds, like `SimulatedWorld.sense` and `.scene`.

        Args:
            active: (G,) numbers of the worlds, rising.
        """
        places = self._joined.bodies.places[self._own[active]]
        poses = pose_matrices(places[:, :3], places[:, 3:])
        refresh_worlds(active, self._joined)
        scenes = np.zeros(len(active), SCENE)
        scenes["time_s"], scenes["robot"] = self._times(active), _planar(poses)
        scenes["velocity"] = self._speeds(active, poses)
        images = self._take_images(active, poses, scenes["velocity"][:, 1])
        sonar_m = self._sonar.read(active, poses)
        people, first = self._visibility.look(active, poses, scenes["robot"])
        scenes["first"], scenes["end"] = first[:-1], first[1:]
        contacts = tuple([self._worlds[number].touching for number in active.tolist()])
        scenes["is_touching"] = [bool(names) for names in contacts]
        names = tuple([self._names[number] for number in active.tolist()])
        return Snapshot(
            numbers=active,
            sonar_m=sonar_m,
            odometry=self._drives.gears.odometry[active],
            wheel_speeds_m_s=self._joined.motion.speeds[active] * WHEEL_RADIUS_M,
            scenes=Scenes(scenes, people, names, contacts),
            images=images,
        )

    def _take_images(self, active: Numbers, poses: Matrix, turn_rad_s: Array) -> BatchImages | None:
        if self._eyes is not None:
            return self._eyes.look(active, poses, turn_rad_s)
        worlds = [self._worlds[number] for number in active.tolist()]
        return SeparateImages([world.take_images() for world in worlds]) if worlds[0].has_images else None

    def _times(self, active: Numbers) -> Array:
        return np.array([self._worlds[number].time_s for number in active.tolist()])

    def _speeds(self, active: Numbers, poses: Matrix) -> Array:
        """(G, 2) true forward speed [m/s] and turn rate [rad/s] of each robot."""
        velocity = self._joined.motion.velocity[active]
        linear = velocity.copy()
        linear[:, 2] = 0.0
        ahead = (linear[:, None, :] @ poses[:, :3, 0][:, :, None])[:, 0, 0]
        return np.stack([ahead, velocity[:, 2]], axis=1)


def batch_key(world: SimulatedWorld) -> tuple[object, ...] | None:
    """Return the key shared by all worlds of a batch; None for a world that cannot be in one."""
    config = world.config
    if config.physics != "kinematic":
        return None
    camera = flat_geometry(config.robot.cameras, "thermal")
    views = world.has_images, shared_cameras(world)
    return config.physics_hz, config.control_hz, config.robot.sonar, camera, views


def _planar(poses: Matrix) -> Array:
    """(G, 3) x, y [m], heading [rad] of poses (G, 4, 4)."""
    headings = map(math.atan2, poses[:, 1, 0].tolist(), poses[:, 0, 0].tolist())
    return np.column_stack([poses[:, :2, 3], list(headings)])


def _kinematic(world: SimulatedWorld) -> Kinematic:
    assert isinstance(world.physics, Kinematic)
    return world.physics


class WorldBatch:
    """Worlds by number: kinematic worlds in one batch per kind, others separately."""

    def __init__(self, worlds: Sequence[SimulatedWorld], workers: WorkerPool) -> None:
        self._worlds = tuple(worlds)
        kinds: dict[object, list[int]] = defaultdict(list)
        for number, world in enumerate(worlds):
            kinds[batch_key(world)].append(number)
        self._alone = kinds.pop(None, [])
        self._batches = [
            (KinematicBatch([worlds[number] for number in group], workers), np.array(group, np.int64))
            for group in kinds.values()
        ]

    def step(self, active: Numbers, commands: Array) -> list[Snapshot]:
        """Step some of the worlds, and take_snapshot what is in them then.

        Args:
            active: (G,) numbers of the worlds, rising.
            commands: (G, 2) speeds [m/s, rad/s].

        Returns:
            What is perceived in all of them, as many worlds at a time as are stepped together.

        Raises:
            BadInput: a command is not finite.
        """
        found = []
        for number in self._alone:
            for k in np.flatnonzero(active == number).tolist():
                world = self._worlds[number]
                world.step(*commands[k].tolist())
                found.append(take_snapshot(world)._replace(numbers=active[k : k + 1]))
        row = np.full(len(self._worlds), -1)
        row[active] = np.arange(len(active))
        for batch, group in self._batches:
            own = np.flatnonzero(row[group] >= 0)
            if len(own):
                batch.step(own, commands[row[group[own]]])
                found.append(batch.look(own)._replace(numbers=group[own]))
        return found
