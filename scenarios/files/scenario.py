"""A validated scenario, ready to run with any seed."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from peopleboy.bad_input import BadInput, Key, found_in
from peopleboy.behaviours.behaviour import Behaviour, Command
from peopleboy.behaviours.corridor.corridor_from_image import CorridorCamera
from peopleboy.behaviours.corridor.follow_corridor import FollowCorridorConfig
from peopleboy.behaviours.following.follow_person import FollowConfig
from peopleboy.behaviours.make_behaviour import is_own, make_behaviour
from peopleboy.random_streams import stream
from peopleboy.scenarios.files.check import Ground, check_scenario, make_ground
from peopleboy.scenarios.files.own_files import read_own_files
from peopleboy.scenarios.files.people import PersonSpec, assign_distinct_colours, make_config, resolve_person
from peopleboy.scenarios.files.recorded_drives import KEPT, Repeat, pack_drive, read_drive
from peopleboy.scenarios.files.robot import RobotSpec
from peopleboy.scenarios.files.scenario_file import DrawnSpec, Failure, FaultSpec, ScenarioSpec, to_data
from peopleboy.scenarios.files.variation import FAULTS, EpisodeSpec, sample_options
from peopleboy.sim.cameras.kinds import KINDS, flat_geometry
from peopleboy.sim.physics.physics_engine import PHYSICS, PhysicsName
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.places.make_place import make_place
from peopleboy.sim.places.place import Place, air_of
from peopleboy.sim.places.place_config import lay_out
from peopleboy.sim.world_config import CONTROL_HZ, WorldConfig
from peopleboy.wording import counted

RENDERERS = ("raycast", "bullet")


@dataclass(frozen=True, slots=True, eq=False)
class Scenario:
    """A scenario: a place, objects, people, and a robot with a behaviour.

    Attributes:
        spec: contents of the file.
        plan: the floor plan.
        place: all static objects.
        ground: where people can walk.
        files: contents of the scenario's own files, by path relative to its folder.
        drive: commands, one per control step, that replace the robot's behaviour; None for the behaviour.
        own_behaviour: module:Class of a user's behaviour that replaces the file's; None for the file's.
    """

    spec: ScenarioSpec
    plan: FloorPlan
    place: Place
    ground: Ground
    files: Mapping[str, bytes]
    drive: tuple[Command, ...] | None = None
    own_behaviour: str | None = None

    def __repr__(self) -> str:
        """Show name, duration and number of people."""
        people = counted(len(_everybody(self.spec)), "person", "people")
        return f"Scenario({self.name!r}, {self.duration_s:g} s, {people}, robot: {self.robot.behaviour})"

    def _repr_png_(self) -> bytes:
        """Draw the plan, for notebooks."""
        # Imported late: drawings import scenarios, and scenarios must load without matplotlib.
        draw_plan = import_module("peopleboy.scenarios.drawing.draw_plan").draw_plan
        with TemporaryDirectory() as folder:
            path = Path(folder) / "plan.png"
            draw_plan(self, self.seed, path)
            return path.read_bytes()

    @property
    def name(self) -> str:
        """Name of the scenario, one word that is also used for folders."""
        return self.spec.name

    @property
    def description(self) -> str:
        """What happens, in one or two sentences."""
        return " ".join(self.spec.description.split())

    @property
    def duration_s(self) -> float:
        """[s] Duration of a run."""
        return self.spec.duration_s

    @property
    def frames(self) -> int:
        """Number of frames of a run."""
        return round(self.duration_s * CONTROL_HZ) if self.episode is None else self.episode.frames

    @property
    def episode(self) -> EpisodeSpec | None:
        """The episode of an environment that a run repeats; None for a run of its own."""
        return None if self.spec.drawn is None else self.spec.drawn.episode

    @property
    def faults(self) -> tuple[FaultSpec, ...]:
        """Faults of the file, and those that were sampled for the episode that a run repeats."""
        sampled = () if self.episode is None else sampled_faults(self.seed, self.episode.options)
        return (*self.spec.faults, *sampled)

    @property
    def seed(self) -> int:
        """The seed of the run that wrote this scenario file; 0 for any other file."""
        return 0 if self.spec.drawn is None else self.spec.drawn.seed

    @property
    def robot(self) -> RobotSpec:
        """Settings of the robot in the file."""
        return self.spec.robot

    @property
    def tracker(self) -> str:
        """Name of the tracker that is used unless another is requested."""
        from peopleboy.tracker.trackers import DEFAULT_TRACKER  # here, as it takes a second to import

        return self.robot.tracker or DEFAULT_TRACKER

    @property
    def needs_tracker(self) -> bool:
        """Whether the robot's commands depend on what a tracker finds in the images."""
        is_own = self.own_behaviour is not None
        return self.drive is None and (is_own or self.robot.behaviour not in ("stand", "scripted"))

    @property
    def needs_every_frame(self) -> bool:
        """Whether images of later frames depend on those of all earlier ones, so that none can be skipped."""
        return self.needs_tracker or bool(self.faults)

    def people(self, seed: int) -> tuple[PersonSpec, ...]:
        """Return all people, including group members, resolved with a seed.

        Raises:
            BadInput: the seed is negative.
        """
        if seed < 0:
            raise BadInput(f"seed {seed} must be 0 or more")
        people = tuple(person for _, person in _everybody(self.spec))
        if self.spec.clothes_differ:
            people = assign_distinct_colours(people, stream(seed, "scenario.colours"))
        air_c = air_of(self.place) if self.spec.detail == "full" else None
        return tuple(
            resolve_person(
                person, seed, lambda one: self.ground.fault(one) is None, self.ground.routed, air_c
            )
            for person in people
        )

    def world(self, seed: int, renderer: str = "raycast") -> WorldConfig:
        """Return the settings of the world; the same seed gives equal settings.

        Raises:
            BadInput: the seed is negative, or the renderer is unknown.
        """
        if renderer not in RENDERERS:
            raise BadInput(f"unknown renderer {renderer!r}; choose from {', '.join(RENDERERS)}")
        config = WorldConfig(
            place=self.place,
            people=tuple(make_config(person) for person in self.people(seed)),
            robot=self.robot.config(),
            seed=seed,
            renderer=renderer,
            physics=self.spec.physics,
            detail=self.spec.detail,
            bodies=self.spec.bodies,
        )
        return config if self.episode is None else self.episode.applied_to(config)

    def mounting(self, cameras: Sequence[str]) -> "Scenario":
        """Return the same scenario with these cameras mounted on the robot; new ones get default settings.

        Args:
            cameras: names, each of a camera on the robot or of a kind of camera.

        Raises:
            BadInput: a name is neither a camera of the robot nor a kind of camera.
        """
        lacking = [name for name in dict.fromkeys(cameras) if name not in self.robot.config().cameras]
        if not lacking:
            return self
        for name in lacking:
            if name not in KINDS:
                raise BadInput(
                    f"camera {name!r}: the tracker needs it, but there is no kind of camera with that name "
                    f"(kinds: {', '.join(KINDS)}); mount one in robot.cameras"
                )
        return self.with_cameras({name: {"kind": name} for name in lacking})

    def with_cameras(self, cameras: Mapping[str, Mapping[str, object]]) -> "Scenario":
        """Return the same scenario with these cameras on the robot; cameras of the same name are replaced."""
        return replace(self, spec=replace(self.spec, robot=self.robot.with_cameras(cameras)))

    def lasting(self, duration_s: float) -> "Scenario":
        """Return the same scenario with another duration."""
        drawn, frames = self.spec.drawn, round(duration_s * CONTROL_HZ)
        if drawn is not None and drawn.episode is not None:
            drawn = replace(drawn, episode=replace(drawn.episode, frames=frames))
        return replace(self, spec=replace(self.spec, duration_s=duration_s, drawn=drawn))

    def as_episode(self, seed: int, episode: EpisodeSpec | None) -> "Scenario":
        """Return the scenario of an episode that was played with a seed, or without one."""
        drawn = None if episode is None else DrawnSpec(seed=seed, episode=episode)
        return replace(self, spec=replace(self.spec, drawn=drawn))

    def driven(self, drive: Sequence[Command]) -> "Scenario":
        """Return the same scenario with a robot that replays recorded commands."""
        return replace(self, drive=tuple(drive))

    def steered_by(self, behaviour: str) -> "Scenario":
        """Return the same scenario with another behaviour for the robot.

        A user's behaviour, given as module:Class, is not written to the file; the task stays the file's.

        Raises:
            BadInput: the behaviour is unknown.
        """
        make_behaviour(behaviour)  # refuses an unknown name
        if is_own(behaviour):
            return replace(self, drive=None, own_behaviour=behaviour)
        robot = replace(self.robot, behaviour=behaviour)
        return replace(self, spec=replace(self.spec, robot=robot), drive=None, own_behaviour=None)

    def moved_by(self, physics: PhysicsName | str) -> "Scenario":
        """Return the same scenario with other physics for the robot.

        Raises:
            BadInput: the physics are unknown.
        """
        if not isinstance(physics, str) or physics not in PHYSICS:
            raise BadInput(f"unknown physics {physics!r}; choose from {', '.join(PHYSICS)}")
        return replace(self, spec=replace(self.spec, physics=physics))

    def make_behaviour(self) -> Behaviour:
        """Return a new instance of the behaviour that drives the robot."""
        if self.drive is not None:
            return Repeat(self.drive)
        script = [
            (c.from_s, Command(linear_m_s=c.linear_m_s, angular_rad_s=math.radians(c.angular_deg_s)))
            for c in self.robot.commands
        ]
        return make_behaviour(
            self.own_behaviour or self.robot.behaviour,
            script=script,
            follow=self.follow_config(),
            corridor=self.corridor_config(),
            goal_m=self.robot.goal_m,
        )

    def follow_config(self) -> FollowConfig:
        """Return gains and limits of a robot that follows a person."""
        robot, default = self.robot, FollowConfig()
        return FollowConfig(
            keep_height=default.keep_height if robot.keep_height is None else robot.keep_height,
            give_up_s=default.give_up_s if robot.give_up_s is None else robot.give_up_s,
        )

    def corridor_config(self) -> FollowCorridorConfig:
        """Return the settings for following a corridor: the sensor that measures walls, and the camera."""
        camera = flat_geometry(self.robot.config().cameras, "colour")
        view = CorridorCamera(focal_px=camera.focal_px, position_m=camera.position_m)
        return FollowCorridorConfig(sense=self.robot.walls_by or "sonar", camera=view)

    def resolved(self, seed: int, versions: dict[str, str] | None = None) -> dict[str, Any]:
        """Return the resolved scenario as plain data; together with `kept_files` it gives the same world.

        Args:
            seed: seed of the run.
            versions: package versions by name, stored with the seed.
        """
        drawn = DrawnSpec(
            seed=seed,
            versions={} if versions is None else versions,
            drive=None if self.drive is None else KEPT,
            episode=self.episode,
        )
        return to_data(replace(self.spec, people=self.people(seed), groups=(), drawn=drawn))

    def kept_files(self) -> dict[str, bytes]:
        """Return the contents of all files that the resolved scenario refers to, by relative path."""
        return dict(self.files) | ({} if self.drive is None else {KEPT: pack_drive(self.drive)})


def sampled_faults(seed: int, ranges: Mapping[str, list[float]]) -> tuple[FaultSpec, ...]:
    """Return the faults that the options of an episode ask for, see `peopleboy.scenarios.files.variation`."""
    drawn, _ = sample_options(seed, ranges)
    kinds: tuple[Failure, ...] = FAULTS
    return tuple(FaultSpec(kind=kind, from_s=0.0, strength=drawn[kind]) for kind in kinds if drawn.get(kind))


def make_scenario(spec: ScenarioSpec, folder: Path, *, is_checked: bool = True) -> Scenario:
    """Build and check everything that does not depend on the seed.

    Args:
        spec: contents of the file.
        folder: folder of the file.
        is_checked: whether to check paths, people and the robot; without, the scenario can only be drawn.

    Raises:
        BadInput: the scenario is invalid; the message starts with the key or with the file it refers to.
    """
    everybody = _everybody(spec)
    with found_in("place"):
        plan = lay_out(spec.place)
    place = make_place(
        spec.place,
        plan,
        spec.things,
        lights=[(step.at_s, step.level) for step in spec.lights],
        people=[person.name for _, person in everybody],
        duration_s=spec.duration_s,
        folder=folder,
    )
    ground = make_ground(spec, plan, place)
    if is_checked:
        check_scenario(spec, everybody, ground)
    is_driven = spec.drawn is not None and spec.drawn.drive is not None
    return Scenario(
        spec=spec,
        plan=plan,
        place=place,
        ground=ground,
        files=read_own_files(spec, folder),
        drive=read_drive(folder / KEPT) if is_driven else None,
    )


def _everybody(spec: ScenarioSpec) -> tuple[tuple[Key, PersonSpec], ...]:
    """Return all people with their keys in the file."""
    found: list[tuple[Key, PersonSpec]] = [
        (("people", index), person) for index, person in enumerate(spec.people)
    ]
    for index, group in enumerate(spec.groups):
        found += [(("groups", index), person) for person in group.members()]
    return tuple(found)
