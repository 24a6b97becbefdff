"""The visible bodies of people in many worlds, posed by kernels over all of them."""

from collections.abc import Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numba import njit

from peopleboy.sim.batch.drive import BatchWalks, JoinedWorlds
from peopleboy.sim.geometry.poses import quaternions
from peopleboy.sim.people.body.body_placement import carry, put_on_floor
from peopleboy.sim.people.motion.stance import STANCE, Builds, Stances, hold, move_limbs
from peopleboy.sim.people.person import pace_m_s
from peopleboy.sim.people.walking.script import Records, join_records
from peopleboy.sim.physics.kinematic import Kinematic
from peopleboy.sim.physics.solid_shapes import Array
from peopleboy.sim.shapes.shape_table import Numbers
from peopleboy.sim.world import SimulatedWorld


class Parts(NamedTuple):
    """The parts of Q people, one person after the other.

    Attributes:
        offsets, supports: (Q, 17, 3) and (Q, 12, 3) [m] as in `BodyFrame`.
        first: (Q + 1,) where each one's parts begin.
        bone, part_offset: of all parts, as in `BodyFrame`.
        body: (P,) number of the body that is a part, among those of all worlds.
    """

    offsets: Array
    supports: Array
    first: Numbers
    bone: Numbers
    part_offset: Array
    body: Numbers


class BatchLimbs:
    """The limbs of all people in B worlds with images.

    Args:
        worlds: of a batch.
        walks: where everybody goes.
        joined: where all bodies are.
    """

    def __init__(self, worlds: Sequence[SimulatedWorld], walks: BatchWalks, joined: JoinedWorlds) -> None:
        self._walks, self._joined = walks, joined
        self._people = [person for world in worlds for person in world.crowd.people]
        self._stances = join_records([each.stance for each in self._people], STANCE)
        self._builds = Builds(*map(np.concatenate, zip(*(each.build for each in self._people), strict=True)))
        for q, person in enumerate(self._people):
            own = slice(q, q + 1)
            person.rebind(self._stances[own], Builds._make(array[own] for array in self._builds))
        self._handle_things = any(world.config.place.movers for world in worlds)
        gaits = [person.model.gait for person in self._people]
        self._unit_stride_m = np.array([gait.unit_stride_m for gait in gaits])
        self._parts = self._know_parts(worlds)

    def move(self, active: Numbers, times_s: Array, dt_s: float) -> None:
        """Advance gaits and postures of people in some worlds who have just been moved by kernels.

        Args:
            active: (G,) numbers of the worlds.
            times_s: (G,) [s] in each of them at the start of the step.
            dt_s: [s] length of the step.
        """
        walks = self._walks
        records = walks.records
        velocities, turns = records["velocity"].tolist(), records["turn_rate"].tolist()
        paces = [pace_m_s(velocity, turn) for velocity, turn in zip(velocities, turns, strict=True)]
        _move(
            active[walks.is_scripted[active]], walks.first, records, self._stances, self._unit_stride_m,
            self._builds.root_scale, np.array(paces), times_s[walks.is_scripted[active]], dt_s,
        )  # fmt: skip

    def place(self, active: Numbers) -> None:
        """Place the parts of all people in some worlds, except people who handle a thing."""
        walks = self._walks
        is_going = np.zeros(len(walks.is_scripted), np.bool_)
        is_going[active] = True
        who = np.flatnonzero(walks.records["is_present"] & is_going[walks.world])
        if self._handle_things:
            who = who[[not self._people[q].is_handling for q in who.tolist()]]
        places = np.column_stack([walks.records["position"][who], walks.records["heading"][who]])
        _place(who, places, self._builds, self._stances, self._parts, self._joined)

    def _know_parts(self, worlds: Sequence[SimulatedWorld]) -> Parts:
        frames = [person.model.frame for person in self._people]
        counts = [len(frame.bone) for frame in frames]
        return Parts(
            offsets=np.stack([frame.offsets for frame in frames]),
            supports=np.stack([frame.supports for frame in frames]),
            first=np.array(list(accumulate(counts, initial=0)), np.int64),
            bone=np.concatenate([frame.bone for frame in frames]),
            part_offset=np.concatenate([frame.part_offset for frame in frames]),
            body=np.array(
                [
                    first + _number_of(world, key)
                    for world, first in zip(worlds, self._joined.first_body.tolist(), strict=False)
                    for person in world.crowd.people
                    for key in person.model.part_keys
                ],
                np.int64,
            ),
        )


def _number_of(world: SimulatedWorld, key: str) -> int:
    assert isinstance(world.physics, Kinematic)
    return world.physics.numbers[key]


@njit(cache=True, nogil=True)
def _move(
    active: Numbers,
    first: Numbers,
    walks: Records,
    stances: Stances,
    unit_stride_m: Array,
    root_scale: Array,
    paces: Array,
    times_s: Array,
    dt_s: float,
) -> None:
    for row in range(len(active)):
        for q in range(first[active[row]], first[active[row] + 1]):
            walk = walks[q]
            stances[q].time_s = times_s[row] + dt_s
            if walk.has_moved and walk.is_present:
                move_limbs(
                    stances, q, unit_stride_m[q], root_scale[q], paces[q], walk.turn_rate, walk.piece >= 0,
                    walk.posture, dt_s,
                )  # fmt: skip


@njit(cache=True, nogil=True)
def _place(
    who: Numbers, places: Array, people: Builds, stances: Stances, parts: Parts, joined: JoinedWorlds
) -> None:
    count = parts.offsets.shape[1]
    bones, turns = np.empty((count + 1, 4, 4)), np.empty((count, 3))
    bodies = joined.bodies
    for k in range(len(who)):
        q, place = who[k], (places[k, 0], places[k, 1], places[k, 2])
        shift = hold(people, stances, q, turns)
        put_on_floor(turns, parts.offsets[q], parts.supports[q], shift, place, bones)
        first, end = parts.first[q], parts.first[q + 1]
        poses = np.empty((end - first, 4, 4))
        carry(bones, parts.bone[first:end], parts.part_offset[first:end], poses)
        turned = quaternions(poses)
        for p in range(first, end):
            body = parts.body[p]
            bodies.places[body, :3] = poses[p - first, :3, 3]
            bodies.places[body, 3:] = turned[p - first]
            bodies.stale[body] = True
