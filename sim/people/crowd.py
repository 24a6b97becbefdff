"""The people of a world: they follow their scripts, and their bodies and hands move in the physics world."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from peopleboy.random_streams import stream
from peopleboy.sim.geometry.poses import quaternions
from peopleboy.sim.people.appearance.finisher import Finisher, appearance_stream
from peopleboy.sim.people.body.bodies import choose_body
from peopleboy.sim.people.body.garments import bare_stature
from peopleboy.sim.people.person import Person
from peopleboy.sim.people.person_config import BodyShape, PersonConfig
from peopleboy.sim.people.walking.script import (
    WALK,
    Records,
    Script,
    is_scripted,
    join_records,
    join_scripts,
)
from peopleboy.sim.people.walking.social_force import PlanarState, robot_motion
from peopleboy.sim.people.walking.walk_kernels import walk_on
from peopleboy.sim.people.walking.walker import Present
from peopleboy.sim.physics.physics_engine import Physics
from peopleboy.sim.places.moving import Action, Mover, ThingState, ease
from peopleboy.sim.places.place import Place, air_of, is_outdoors
from peopleboy.sim.shapes.materials import Detail, Material
from peopleboy.sim.shapes.shapes import UPRIGHT, Part, Shape, ShapeKind

# Contacts and sonar use an upright capsule, which no camera sees.
_SOLID = "solid"

_TWO = 2.0  # see `walk_on`
_OUT_OF_REACH_M = 1.5  # person and robot cannot meet within a control step from this distance


class Crowd:
    """All people of a world, with their bodies.

    Each visible part is a separate body, placed by the gait. Contacts and sonar use one upright capsule per
    person instead, which moves in every physics step. A person who appears where the robot stands has no
    capsule until they are apart, as physics would throw the robot away. Without cameras, people consist of
    that capsule alone.

    Attributes:
        is_scripted: whether all people only follow scripts and give way, among static walls.
        walks: (N,) records WALK, the state of all walks.
    """

    def __init__(
        self,
        physics: Physics,
        configs: Sequence[PersonConfig],
        place: Place,
        seed: int,
        *,
        is_visible: bool,
        detail: Detail = "plain",
        bodies: BodyShape = "capsules",
    ) -> None:
        self._physics = physics
        self._is_visible = is_visible
        self._place = place
        self._bodies = bodies
        self._is_fine = is_visible and detail == "full"
        self.people = tuple(self._make(config, seed) for config in configs)
        self.materials: dict[str, Material] = {}
        stands_still = not (place.movers and any(config.yields for config in configs))
        self.is_scripted = stands_still and all(map(is_scripted, configs))
        self._scripts = join_scripts(self.scripts)
        self.rebind(join_records([person.walker.walks for person in self.people], WALK))
        self._is_shown = dict.fromkeys((person.name for person in self.people), True)
        self._solid: set[str] = set()
        self._before: dict[str, NDArray[np.float64]] = {}
        for person in self.people:
            self._add(person)

    @property
    def scripts(self) -> tuple[Script, ...]:
        """The scripts of all people."""
        return tuple(person.walker.script for person in self.people)

    @property
    def walls(self) -> NDArray[np.float64]:
        """(K, 4) [m] rectangles min_x, min_y, max_x, max_y that a scripted crowd avoids."""
        return self._place.obstacles

    def rebind(self, walks: Records) -> None:
        """Use another array for the walk records from now on; it must hold the same values already."""
        self.walks = walks
        for k, person in enumerate(self.people):
            person.walker.rebind(walks[k : k + 1])

    def step(self, time_s: float, dt_s: float, robot: PlanarState) -> None:
        """Advance all people by dt_s from time_s, given the current states of the others and the robot."""
        self._before.clear()
        for person in self.people:
            if person.name in self._solid and math.dist(person.position, robot.position) < _OUT_OF_REACH_M:
                self._before[person.name] = person.position
        if self.is_scripted:
            count, walls = len(self.people), self._place.obstacles
            walk_on(0, count, self.walks, self._scripts, time_s, dt_s, robot_motion(robot), walls, _TWO)
            for person in self.people:
                person.move_limbs(dt_s)
        else:
            self._step_each(time_s, dt_s, robot)

    def _step_each(self, time_s: float, dt_s: float, robot: PlanarState) -> None:
        """Advance people one after the other, each with its own decisions."""
        present, obstacles = those_present(self.people), self._place.obstacles_at(time_s)
        members = [(p, p.progress) for p in self.people if p.present and p.config.group is not None]
        for person in self.people:
            company = [
                progress
                for other, progress in members
                if other is not person and other.config.group == person.config.group
            ]
            person.step(time_s, dt_s, present, robot, obstacles, company)

    def move_bodies(self, share: float) -> None:
        """Move the solid capsules to the people's positions at a share of the control step.

        This applies to people near the robot; all others are placed at the end of the step at once.
        """
        for person in self.people:
            before = self._before.get(person.name)
            if before is not None:
                self._place_solid(person, before + share * (person.position - before))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all people, present or not."""
        return tuple(person.name for person in self.people)

    @property
    def capsules(self) -> tuple[str, ...]:
        """Names of the solid bodies of people."""
        return tuple(f"{person.name}/{_SOLID}" for person in self.people)

    def show(self, gap_to_robot: Callable[[float, float], float]) -> None:
        """Place every visible part at its person's current pose; absent people are hidden.

        Args:
            gap_to_robot: distance [m] between the robot's outline and a point x, y [m] on the floor.
        """
        present = [person for person in self.people if person.present]
        for person in self.people:
            if person.present != self._is_shown[person.name]:
                self._set_shown(person, person.present)
        for person in present:
            self._place_solid(person, person.position)
            self._make_solid(person, gap_to_robot)
        if self._is_visible and present:
            names = [key for person in present for key in person.model.part_keys]
            poses = np.concatenate([person.poses() for person in present])
            self._physics.set_poses(names, poses[:, :3, 3], quaternions(poses))

    def _make(self, config: PersonConfig, seed: int) -> Person:
        name = f"person.{config.name}"
        body = None
        if self._bodies == "skins":
            bare_m = bare_stature(config.height_m, config.clothes)
            rng = stream(seed, f"{name}.body")
            body = choose_body(config.age, config.sex, config.build, bare_m, rng)
        finisher = self._finisher(config, seed) if self._is_fine else None
        return Person(config, stream(seed, name), finisher, body, air_of(self._place))

    def _finisher(self, config: PersonConfig, seed: int) -> Finisher:
        """Return the finisher of a person, for the air of the place."""
        rng = appearance_stream(seed, config.name)
        return Finisher(config, air_of(self._place), rng, is_outdoors=is_outdoors(self._place))

    def _add(self, person: Person) -> None:
        for key, part in self._visible_parts(person):
            self._physics.add_part(key, part.shapes, solid=False)
            self.materials[key] = part.material
        radius, height = person.model.radius_m, person.config.height_m
        capsule = Shape(kind=ShapeKind.CAPSULE, size=(height - 2.0 * radius, radius, 0.0))
        self._physics.add_part(f"{person.name}/{_SOLID}", [capsule], visible=False)
        self._physics.set_hidden(f"{person.name}/{_SOLID}", True)
        self.materials[f"{person.name}/{_SOLID}"] = person.model.parts[0].material

    def _set_shown(self, person: Person, is_shown: bool) -> None:
        self._is_shown[person.name] = is_shown
        for key, _ in self._visible_parts(person):
            self._physics.set_hidden(key, not is_shown)
        if not is_shown:
            self._solid.discard(person.name)
            self._physics.set_hidden(f"{person.name}/{_SOLID}", True)

    def _make_solid(self, person: Person, gap_to_robot: Callable[[float, float], float]) -> None:
        """Make the solid capsule of a person who has just appeared, as soon as the robot is outside it."""
        if person.name not in self._solid and gap_to_robot(*person.position.tolist()) > person.model.radius_m:
            self._solid.add(person.name)
            self._physics.set_hidden(f"{person.name}/{_SOLID}", False)

    def _visible_parts(self, person: Person) -> list[tuple[str, Part]]:
        return list(zip(person.model.part_keys, person.model.parts, strict=True)) if self._is_visible else []

    def _place_solid(self, person: Person, position: NDArray[np.float64]) -> None:
        at = (float(position[0]), float(position[1]), person.config.height_m / 2.0)
        self._physics.set_pose(f"{person.name}/{_SOLID}", at, UPRIGHT)


def those_present(people: Sequence[Person]) -> Present:
    """Return positions and velocities of the people who are in the world now."""
    there = [person for person in people if person.present]
    motion = np.array([(*person.position, *person.velocity) for person in there], np.float64)
    return Present({person.name: row for row, person in enumerate(there)}, motion.reshape(-1, 4))


REACH_S = 0.6  # time for a hand to reach a thing, and to return


class Handling:
    """Places moving things, and the hands of the people who move them.

    Args:
        physics: the physics world with all fixtures of the place.
        place: the place with the movers.
        people: the people who may move them.
    """

    def __init__(self, physics: Physics, place: Place, people: Sequence[Person]) -> None:
        self._physics = physics
        self._movers = place.movers
        self._people = {person.name: person for person in people}
        self._bodies = {
            mover.name: [f.name for f in place.fixtures if f.name.split("/")[0] == mover.name]
            for mover in place.movers
        }
        self._shown: dict[str, ThingState] = {}
        self._by = [(mover, action) for mover in place.movers for action in mover.actions if action.by]

    def show(self, time_s: float) -> None:
        """Place things and hands as they are at a time [s]."""
        for mover in self._movers:
            self._put(mover, mover.at(time_s))
        for name in dict.fromkeys(str(action.by) for _, action in self._by):
            self._reach(self._people[name], time_s)

    def _put(self, mover: Mover, state: ThingState) -> None:
        before = self._shown.get(mover.name)
        for body in self._bodies[mover.name]:
            if before is None or before.stance != state.stance:
                self._physics.set_pose(body, state.stance.position_m, state.stance.orientation)
            if before is None or before.is_there != state.is_there:
                self._physics.set_hidden(body, not state.is_there)
        self._shown[mover.name] = state

    def _reach(self, person: Person, time_s: float) -> None:
        """Place a person's hand at the thing that it moves, on the way there, or hanging."""
        own = [(mover, action) for mover, action in self._by if action.by == person.name]
        mover, action = max(own, key=lambda one: (_share(one[1], time_s), one[1].at_s))
        share = _share(action, time_s)
        if share <= 0.0:
            person.let_go()
            return
        x, y = person.position.tolist()
        halfway = mover.grip(action, (action.at_s + action.ends_s) / 2.0, (x, y))
        person.reach_for(mover.grip(action, time_s, (x, y)), ease(share), halfway)


def _share(action: Action, time_s: float) -> float:
    """Return how far the hand has reached: 1 during the action, less before and after it."""
    away_s = max(action.at_s - time_s, time_s - action.ends_s, 0.0)
    return max(1.0 - away_s / REACH_S, 0.0)
