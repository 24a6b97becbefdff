"""One control step of many worlds: joined states, walking people, and robots."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.people.walking.script import WALK, Records, Scripts, join_records, join_scripts
from peopleboy.sim.people.walking.walk_kernels import walk_on
from peopleboy.sim.physics.kinematic import Kinematic
from peopleboy.sim.physics.solid_shapes import Array, Placements, Solids, refresh
from peopleboy.sim.physics.vehicle import Vehicle, VehicleMotion, VehicleState, advance
from peopleboy.sim.robot.peoplebot import Gears, approach_target, count_travel
from peopleboy.sim.robot.robot_body import WHEEL_RADIUS_M, wheel_speeds
from peopleboy.sim.shapes.shape_table import JoinedTables, Numbers, ends, join_tables, table_of
from peopleboy.sim.world import SimulatedWorld


class JoinedWorlds(NamedTuple):
    """Joined state of B worlds; indices within them are those of each single world.

    Attributes:
        bodies: of all worlds, one world after the other.
        tables: of their solids.
        poses, boxes: of all solids, as in `Solids`.
        motion: of each world's vehicle, one row each.
        own: (B,) number of the vehicle's body.
        first_body, first_part: (B + 1,) where those of each world begin, and where the last end.
    """

    bodies: Placements
    tables: JoinedTables
    poses: Array
    boxes: Array
    motion: VehicleMotion
    own: Numbers
    first_body: Numbers
    first_part: Numbers


def join_worlds(states: Sequence[VehicleState]) -> tuple[JoinedWorlds, list[VehicleState]]:
    """Copy the states of worlds into joint arrays.

    Returns:
        The arrays, and each world's state anew, which lies in them.
    """
    joined = JoinedWorlds(
        bodies=Placements(*map(np.concatenate, zip(*(state.bodies for state in states), strict=True))),
        tables=join_tables([state.solids.table for state in states]),
        poses=np.concatenate([state.solids.poses for state in states]),
        boxes=np.concatenate([state.solids.boxes for state in states]),
        motion=VehicleMotion(*map(np.stack, zip(*(state.motion for state in states), strict=True))),
        own=np.array([state.own for state in states], np.int64),
        first_body=ends([len(state.bodies.places) for state in states]),
        first_part=ends([len(state.bodies.of_part) for state in states]),
    )
    return joined, [_state_in(joined, number, state) for number, state in enumerate(states)]


def _state_in(joined: JoinedWorlds, number: int, before: VehicleState) -> VehicleState:
    bodies, solids = slice_world.py_func(joined, number)
    motion = VehicleMotion(*(array[number] for array in joined.motion))
    return before._replace(bodies=bodies, solids=solids._replace(table=before.solids.table), motion=motion)


@njit(cache=True, nogil=True)
def slice_world(joined: JoinedWorlds, number: int) -> tuple[Placements, Solids]:
    """Return the bodies and solids of one world."""
    b, b_end = joined.first_body[number], joined.first_body[number + 1]
    p, p_end = joined.first_part[number], joined.first_part[number + 1]
    s, s_end = joined.tables.shape[number], joined.tables.shape[number + 1]
    bodies = Placements(
        joined.bodies.places[b:b_end],
        joined.bodies.hidden[b:b_end],
        joined.bodies.stale[b:b_end],
        joined.bodies.of_part[p:p_end],
        joined.bodies.base_from_part[p:p_end],
        joined.bodies.poses[p:p_end],
    )
    return bodies, Solids(table_of(joined.tables, number), joined.poses[s:s_end], joined.boxes[s:s_end])


@njit(cache=True, nogil=True)
def refresh_worlds(active: Numbers, joined: JoinedWorlds) -> None:
    """Update some of the worlds, as `refresh` does for one."""
    for number in active:
        bodies, solids = slice_world(joined, number)
        refresh(bodies, solids)


_wheel_speeds = njit(cache=True)(wheel_speeds)


_TWO = 2.0  # see `walk_on`


class BatchWalks:
    """The people of B worlds, whose records move to one joint array.

    Attributes:
        first: (B + 1,) where the people of each world begin.
        world: (Q,) number of each person's world.
        is_scripted: (B,) worlds in which all walk here; in others they walk by themselves.
        makes_way: (B,) those of them in which a person makes way.
        records: (Q,) WALK of all people.
    """

    def __init__(self, worlds: Sequence[SimulatedWorld]) -> None:
        crowds = [world.crowd for world in worlds]
        counts = [len(crowd.people) for crowd in crowds]
        self.first, self.world = ends(counts), np.repeat(np.arange(len(counts)), counts)
        self.is_scripted = np.array([crowd.is_scripted for crowd in crowds], np.bool_)
        self.makes_way = np.array(
            [crowd.is_scripted and bool(crowd.walks["yields"].any()) for crowd in crowds], np.bool_
        )
        self.records = join_records([crowd.walks for crowd in crowds], WALK)
        self._joined = JoinedWalks(
            is_scripted=self.is_scripted,
            first=self.first,
            records=self.records,
            scripts=join_scripts([script for crowd in crowds for script in crowd.scripts]),
            walls=np.concatenate([np.empty((0, 4)), *(crowd.walls for crowd in crowds)]),
            first_wall=ends([len(crowd.walls) for crowd in crowds]),
        )
        for crowd, first, end in zip(crowds, self.first, self.first[1:], strict=False):
            crowd.rebind(self.records[first:end])

    def step(self, active: Numbers, times_s: Array, dt_s: float, robots: Array) -> None:
        """Advance people who only follow scripts; the others have been advanced already.

        Args:
            active: (G,) numbers of the worlds.
            times_s: (G,) [s] in each of them at the start of the step.
            dt_s: [s] length of the step.
            robots: (G, 5) their robots, as of `RobotMotion`; velocities count where a person makes way.
        """
        _walk_worlds(active, self._joined, times_s, dt_s, robots, _TWO)


class JoinedWalks(NamedTuple):
    """All people and walls of B worlds in the format of the kernels; see `BatchWalks`."""

    is_scripted: NDArray[np.bool_]
    first: Numbers
    records: Records
    scripts: Scripts
    walls: Array
    first_wall: Numbers


@njit(cache=True, nogil=True)
def _walk_worlds(
    active: Numbers, walks: JoinedWalks, times_s: Array, dt_s: float, robots: Array, two: float
) -> None:
    for row in range(len(active)):
        world = active[row]
        if walks.is_scripted[world]:
            robot = (robots[row, 0], robots[row, 1], robots[row, 2], robots[row, 3], robots[row, 4])
            walls = walks.walls[walks.first_wall[world] : walks.first_wall[world + 1]]
            first, end = walks.first[world], walks.first[world + 1]
            walk_on(first, end, walks.records, walks.scripts, times_s[row], dt_s, robot, walls, two)


class BatchCapsules(NamedTuple):
    """Q people of all worlds, one world after the other.

    Attributes:
        first: (B + 1,) where each world's begin.
        body: (Q,) number of the upright capsule that stands for a person, within its world.
        is_solid: (Q,) whether it is there to be met.
        middle_m: (Q,) [m] height of its middle.
        before, after: (Q, 2) [m] where it stands at the start and at the end of the step.
    """

    first: Numbers
    body: Numbers
    is_solid: NDArray[np.bool_]
    middle_m: Array
    before: Array
    after: Array


@njit(cache=True, nogil=True)
def drive_step(
    active: Numbers,
    joined: JoinedWorlds,
    vehicle: Vehicle,
    gears: Gears,
    noise_m: Array,
    people: BatchCapsules,
    dt_s: float,
    steps: int,
    touched: NDArray[np.bool_],
) -> None:
    """Do the physics steps of `SimulatedWorld.step` for the given worlds.

    Args:
        active: (G,) numbers of the worlds.
        joined: changed in place.
        vehicle: all robots.
        gears: of all robots, with worlds first; `command`, `turned` and `odometry` are changed in place.
        noise_m: (G, 2) [m/sqrt(m)] of the encoders in this step.
        people: who are placed, all of them.
        dt_s: [s] length of a physics step.
        steps: how many of them.
        touched: one for each body of `joined`, gets True for what its robot touched.
    """
    for row in range(len(active)):
        world = active[row]
        bodies, solids = slice_world(joined, world)
        own, motion, robot = joined.own[world], _motion_of(joined.motion, world), _gears_of(gears, world)
        first, end = joined.first_body[world], joined.first_body[world + 1]
        met = np.zeros(end - first, np.bool_)
        for k in range(steps):
            if approach_target(robot, dt_s):
                left, right = _wheel_speeds(robot.command[0], robot.command[1])
                motion.speeds[0], motion.speeds[1] = left / WHEEL_RADIUS_M, right / WHEEL_RADIUS_M
            _move_people(people, world, (k + 1) / steps, bodies)
            refresh(bodies, solids)
            met[:] = False
            advance(vehicle, motion, bodies, solids, own, dt_s, met)
            for body in range(end - first):
                touched[first + body] |= met[body]
        bodies.stale[own] = True
        count_travel(robot, motion.angles, noise_m[row])
        _put_people(people, world, bodies)


@njit(cache=True)
def _motion_of(motion: VehicleMotion, world: int) -> VehicleMotion:
    return VehicleMotion(
        motion.pose[world], motion.angles[world], motion.speeds[world], motion.velocity[world]
    )  # fmt: skip


@njit(cache=True)
def _gears_of(gears: Gears, world: int) -> Gears:
    return Gears(
        gears.command[world], gears.target[world], gears.rise[world], gears.turned[world],
        gears.odometry[world],
    )  # fmt: skip


@njit(cache=True)
def _move_people(people: BatchCapsules, world: int, share: float, bodies: Placements) -> None:
    """Place solid people at this share of the control step."""
    for q in range(people.first[world], people.first[world + 1]):
        if people.is_solid[q]:
            before, after = people.before[q], people.after[q]
            x = before[0] + share * (after[0] - before[0])
            y = before[1] + share * (after[1] - before[1])
            _place(bodies, people.body[q], x, y, people.middle_m[q])


@njit(cache=True)
def _put_people(people: BatchCapsules, world: int, bodies: Placements) -> None:
    """Place solid people at the end of the control step, bit-exactly."""
    for q in range(people.first[world], people.first[world + 1]):
        if people.is_solid[q]:
            _place(bodies, people.body[q], people.after[q, 0], people.after[q, 1], people.middle_m[q])


@njit(cache=True)
def _place(bodies: Placements, body: int, x: float, y: float, z: float) -> None:
    place = bodies.places[body]
    place[0], place[1], place[2] = x, y, z
    place[3], place[4], place[5], place[6] = 0.0, 0.0, 0.0, 1.0
    bodies.stale[body] = True


class BatchDrive:
    """The robots of B worlds, whose drive states move to joint arrays.

    Args:
        worlds: of a batch.
        walks: where everybody goes.
        joined: where all is that they may run into.
        vehicle: what they roll on.

    Attributes:
        gears: of all of them, with worlds first.
    """

    def __init__(
        self, worlds: Sequence[SimulatedWorld], walks: BatchWalks, joined: JoinedWorlds, vehicle: Vehicle
    ) -> None:
        self._robots = [world.robot for world in worlds]
        self._walks, self._joined, self._vehicle = walks, joined, vehicle
        self._capsules = _capsules(worlds, walks)
        self._bodies = joined.first_body[walks.world] + self._capsules.body
        self.gears = Gears(*map(np.stack, zip(*(robot.gears for robot in self._robots), strict=True)))
        for number, robot in enumerate(self._robots):
            robot.rebind(Gears(*(array[number] for array in self.gears)))
        drives = [robot.limits for robot in self._robots]
        self._limits = np.array([each.limits for each in drives])
        self._rise = np.array([each.rise for each in drives])
        self._noise_m = np.array([each.encoder_noise_m for each in drives])
        config = worlds[0].config
        self._dt_s, self._steps = 1.0 / config.physics_hz, config.physics_hz // config.control_hz

    def command(self, active: Numbers, commands: Array) -> None:
        """Set target velocities (G, 2) [m/s, rad/s] in worlds of some numbers (G,), as `PeopleBot.command`.

        Raises:
            BadInput: a command is not finite.
        """
        if not np.isfinite(commands).all():
            raise BadInput("velocity commands must be finite")
        limits = self._limits[active]
        self.gears.target[active] = np.clip(commands, -limits, limits)
        self.gears.rise[active] = self._rise[active]

    @property
    def are_solid(self) -> NDArray[np.bool_]:
        """Return (Q,) whether each person has a solid capsule."""
        are_solid: NDArray[np.bool_] = ~self._joined.bodies.hidden[self._bodies]
        return are_solid

    def drive(self, active: Numbers, before: Array) -> NDArray[np.bool_]:
        """Do the physics of a control step, and update the odometry.

        Args:
            active: (G,) numbers of the worlds.
            before: (Q, 2) [m] where all people stood at its start.

        Returns:
            One for each body of all worlds: whether a robot touched it.
        """
        noise = np.empty((len(active), 2))
        for row, number in enumerate(active.tolist()):
            self._robots[number].draw_noise(noise[row])
        noise *= self._noise_m[active, None]
        # Packed, as those of a single person are anyway, or kernels would be compiled for both layouts.
        before, after = np.ascontiguousarray(before), np.ascontiguousarray(self._walks.records["position"])
        capsules = self._capsules._replace(is_solid=self.are_solid, before=before, after=after)
        touched = np.zeros(len(self._joined.bodies.places), np.bool_)
        drive_step(
            active, self._joined, self._vehicle, self.gears, noise, capsules, self._dt_s, self._steps, touched
        )
        return touched


def _capsules(worlds: Sequence[SimulatedWorld], walks: BatchWalks) -> BatchCapsules:
    """Return the solid capsules of people; their positions follow in each step."""
    people = [person for world in worlds for person in world.crowd.people]
    places = walks.records["position"]
    return BatchCapsules(
        first=walks.first,
        body=np.array([number for world in worlds for number in _capsule_numbers(world)], np.int64),
        is_solid=np.zeros(len(people), np.bool_),
        middle_m=np.array([person.config.height_m for person in people]) / 2.0,
        before=places,
        after=places,
    )


def _capsule_numbers(world: SimulatedWorld) -> list[int]:
    assert isinstance(world.physics, Kinematic)
    return [world.physics.numbers[name] for name in world.crowd.capsules]
