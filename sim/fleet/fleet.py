"""Kinematic worlds that are stepped together."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.fleet.cast_worlds import cast_eyes, hear_worlds, refresh_worlds
from peopleboy.sim.fleet.crew import Crew
from peopleboy.sim.fleet.drive_worlds import Capsules, Robots, drive_worlds
from peopleboy.sim.fleet.eyes import Eyes, cameras_of
from peopleboy.sim.fleet.hold_people import Limbs
from peopleboy.sim.fleet.instant import Instant
from peopleboy.sim.fleet.shots import Pictures
from peopleboy.sim.fleet.side_by_side import lay_side_by_side
from peopleboy.sim.fleet.walk_worlds import Walks
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.observation import Senses
from peopleboy.sim.people.person import Person
from peopleboy.sim.physics.kinematic.kinematic import Kinematic
from peopleboy.sim.robot.robot_body import WHEEL_RADIUS_M
from peopleboy.sim.robot.sonar import read_echoes
from peopleboy.sim.truth.bystanders import describe
from peopleboy.sim.truth.image_free_truth import Bystander, ImageFreeTruth
from peopleboy.sim.truth.upright import free_ray_shares, stand_before
from peopleboy.sim.world import World

Command = tuple[float, float]


class Fleet:
    """B worlds, which give to the byte what each would give by itself.

    Their state is copied side by side into arrays, in which the worlds keep looking at it, so that each may
    be asked for anything between steps. Robots, contacts, sonars and who could see whom are worked out by
    kernels over all worlds; people walk as in one.

    Args:
        worlds: kinematic, and of one kind, see `kind_of_fleet`. A world is in one fleet at a time, the last
            that it was put into.
        crew: makes images while Python goes on.
    """

    def __init__(self, worlds: Sequence[World], crew: Crew) -> None:
        self._worlds = tuple(worlds)
        physics = [_kinematic(world) for world in worlds]
        states = [each.state() for each in physics]
        self._joined, laid = lay_side_by_side(states)
        for each, state in zip(physics, laid, strict=True):
            each.lay_into(state)
        self._vehicle = states[0].vehicle
        first = worlds[0]
        self._ring = first.robot.ring
        self._camera = flat_geometry(first.config.robot.cameras, "thermal")
        config = first.config
        self._dt_s, self._steps = 1.0 / config.physics_hz, config.physics_hz // config.control_hz
        self._control_s = 1.0 / config.control_hz
        self._own = self._joined.firsts.body[:-1] + self._joined.own
        self._walks = Walks(worlds)
        self._is_scripted = self._walks.is_scripted.tolist()
        self._know_people(physics)
        shows = worlds[0].has_images and any(world.crowd.people for world in worlds)
        self._limbs = Limbs(worlds, self._walks, self._joined) if shows else None
        wheels = self._joined.firsts.part[:-1, None] + np.array([each.wheels for each in physics])
        makes_images = cameras_of(worlds[0]) is not None
        self._eyes = Eyes(worlds, self._joined, wheels, crew) if makes_images else None

    def step(self, commands: Mapping[int, Command]) -> None:
        """Step some of the worlds, as `World.step` does.

        Args:
            commands: speeds [m/s, rad/s] by the number of the world.
        """
        if self._eyes is not None:
            self._eyes.finish()
        going = np.array(list(commands), np.int64)
        before = self._walks.places()
        self._begin(going, commands)
        robots = self._robots(going)
        capsules = Capsules(
            first=self._walks.first,
            body=self._capsule_bodies,
            is_solid=np.array([is_solid for world in self._worlds for is_solid in world.crowd.are_solid]),
            middle_m=self._heights_m / 2.0,
            before=before,
            after=self._walks.places(),
        )
        if self._limbs is not None:
            self._limbs.place(going)
        touched = np.zeros(len(self._joined.bodies.places), np.bool_)
        drive_worlds(going, self._joined, self._vehicle, robots, capsules, self._dt_s, self._steps, touched)
        firsts, any_touched = self._joined.firsts.body, bool(touched.any())
        rows = zip(going.tolist(), robots.command.tolist(), robots.odometry.tolist(), strict=True)
        for row, (number, (linear, angular), odometry) in enumerate(rows):
            world = self._worlds[number]
            world.robot.take_over((linear, angular), robots.turned[row], Planar(*odometry))
            mine = touched[firsts[number] : firsts[number + 1]] if any_touched else None
            names = set() if mine is None else _kinematic(world).names_of(mine)
            world.end_step(names, are_placed=True)

    def _begin(self, going: NDArray[np.int64], commands: Mapping[int, Command]) -> None:
        """Give robots their commands, and let people walk on."""
        places = self._joined.bodies.places[self._own[going], :2]
        for number, (linear_m_s, angular_rad_s) in commands.items():
            world = self._worlds[number]
            if self._is_scripted[number]:
                world.robot.command(linear_m_s, angular_rad_s)
            else:
                world.begin_step(linear_m_s, angular_rad_s)
        times_s = [self._worlds[number].time_s for number in commands]
        self._walks.step(going, times_s, self._control_s, places)
        if self._limbs is not None:
            self._limbs.move(going, times_s, self._control_s)

    def look(self, numbers: Sequence[int]) -> list[Instant]:
        """Sense and tell the truth in some of the worlds, as `World.sense` and `World.scene` do.

        Args:
            numbers: of the worlds.
        """
        going = np.array(numbers, np.int64)
        places = self._joined.bodies.places[self._own[going]]
        poses = pose_matrices(places[:, :3], places[:, 3:])
        robots = [
            Planar(x, y, math.atan2(sine, cosine))
            for x, y, sine, cosine in poses[:, (0, 1, 1, 0), (3, 3, 0, 0)].tolist()
        ]
        refresh_worlds(going, self._joined)
        speeds = self._speeds(going, poses)
        pictures = self._look_around(going, poses, speeds)
        sonar = self._hear(going, poses)
        people = self._see(going, poses, robots)
        rims = (self._joined.motion.speeds[going] * WHEEL_RADIUS_M).tolist()
        found = []
        for row, number in enumerate(numbers):
            world, robot = self._worlds[number], robots[row]
            left, right = rims[row]
            senses = Senses(
                time_s=world.time_s, sonar_m=sonar[row], odometry=world.robot.odometry,
                wheel_speeds_m_s=(left, right),
            )  # fmt: skip
            if world.has_images:
                senses = world.with_images(senses, None if pictures is None else pictures[row])
            scene = ImageFreeTruth(
                time_s=world.time_s, robot=robot, robot_velocity=speeds[row], contacts=world.touching,
                people=people[row],
            )  # fmt: skip
            found.append(Instant(senses, scene))
        return found

    def _look_around(
        self, going: NDArray[np.int64], poses: Matrix, speeds: Sequence[tuple[float, float]]
    ) -> list[Pictures] | None:
        """Begin with images, if these are worlds whose images are made together."""
        if self._eyes is None:
            return None
        return self._eyes.look(going, poses, np.array([turn for _, turn in speeds]))

    def _know_people(self, physics: Sequence[Kinematic]) -> None:
        """Keep of everybody what never changes."""
        crowds = [world.crowd for world in self._worlds]
        self._people: list[tuple[tuple[int, Person], ...]] = [
            tuple(enumerate(crowd.people, 1)) for crowd in crowds
        ]
        everybody = [person for crowd in crowds for person in crowd.people]
        self._capsule_bodies = np.array(
            [
                each.number_of(name)
                for each, crowd in zip(physics, crowds, strict=True)
                for name in crowd.capsules
            ],
            np.int64,
        )
        self._heights_m = np.array([person.config.height_m for person in everybody])
        self._radii_m = np.array([person.radius_m for person in everybody])

    def _robots(self, going: NDArray[np.int64]) -> Robots:
        robots = [self._worlds[number].robot for number in going.tolist()]
        gears = [robot.gears for robot in robots]
        odometry = [(robot.odometry.x, robot.odometry.y, robot.odometry.heading) for robot in robots]
        return Robots(
            command=np.array([each.command for each in gears]).reshape(-1, 2),
            target=np.array([each.target for each in gears]).reshape(-1, 2),
            rise=np.array([each.rise for each in gears]).reshape(-1, 2),
            turned=np.array([each.turned for each in gears]).reshape(-1, 2),
            odometry=np.array(odometry).reshape(-1, 3),
            noise=np.array([robot.draw_noise() for robot in robots]).reshape(-1, 2),
            noise_m=np.array([robot.encoder_noise_m for robot in robots]),
        )

    def _hear(self, going: NDArray[np.int64], poses: Matrix) -> Matrix:
        """(G, 16) [m] readings of the sonars."""
        ring = self._ring
        turns, shifts = poses[:, :3, :3].transpose(0, 2, 1), poses[:, None, :3, 3]
        starts, ends = ring.starts @ turns + shifts, ring.ends @ turns + shifts
        nearest_m = np.empty((len(going), len(ring.starts)))
        hear_worlds(going, self._joined, starts, ends, ring.reach, nearest_m)
        drawn = [self._worlds[number].robot.ring.draw_noise() for number in going.tolist()]
        noise_m, is_lost = (np.array(each) for each in zip(*drawn, strict=True))
        return read_echoes(nearest_m, noise_m, is_lost, ring.config)

    def _see(
        self, going: NDArray[np.int64], poses: Matrix, robots: Sequence[Planar]
    ) -> list[tuple[Bystander, ...]]:
        """Tell of everybody who is present in the worlds, as `bystanders` does of one."""
        present = [[pair for pair in self._people[number] if pair[1].present] for number in going.tolist()]
        counts = [len(each) for each in present]
        if not any(counts):
            return [()] * len(present)
        row = np.repeat(np.arange(len(going)), counts)
        who = np.array([number - 1 for each in present for number, _ in each])
        who += self._walks.first[going[row]]
        radii_m = self._radii_m[who]
        world_from_camera = poses @ self._camera.robot_from_camera
        places = _rows([person.position for each in present for _, person in each])
        uprights = stand_before(places, self._heights_m[who], radii_m, self._camera, world_from_camera[row])
        fraction = np.ones(uprights.points.shape[:2])
        cast_eyes(
            np.flatnonzero(uprights.reaches_in),
            going[row],
            self._joined,
            uprights.eyes,
            uprights.points,
            fraction,
        )
        boxes, shares = uprights.boxes.tolist(), free_ray_shares(uprights, fraction, radii_m).tolist()
        ends = list(accumulate(counts, initial=0))
        return [
            describe(each, robot, boxes[begin:end], shares[begin:end])
            for each, robot, begin, end in zip(present, robots, ends, ends[1:], strict=False)
        ]

    def _speeds(self, going: NDArray[np.int64], poses: Matrix) -> list[tuple[float, float]]:
        """True forward speed [m/s] and turn rate [rad/s] of each robot."""
        velocity = self._joined.motion.velocity[going]
        linear = velocity.copy()
        linear[:, 2] = 0.0
        ahead = (linear[:, None, :] @ poses[:, :3, 0][:, :, None])[:, 0, 0]
        return list(zip(ahead.tolist(), velocity[:, 2].tolist(), strict=True))


def kind_of_fleet(world: World) -> tuple[object, ...] | None:
    """What all worlds of a fleet must share; None for a world that cannot be in one."""
    config = world.config
    if config.physics != "kinematic":
        return None
    camera = flat_geometry(config.robot.cameras, "thermal")
    views = world.has_images, cameras_of(world)
    return config.physics_hz, config.control_hz, config.robot.sonar, camera, views


def _kinematic(world: World) -> Kinematic:
    assert isinstance(world.physics, Kinematic)
    return world.physics


def _rows(places: Sequence[Matrix]) -> Matrix:
    """Places (2,) as (Q, 2)."""
    return np.array(places).reshape(-1, 2)
