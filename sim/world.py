"""The simulated world, which receives velocity commands and returns observations and ground truth."""

from collections.abc import Collection, Mapping
from functools import partial
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.random_streams import stream
from peopleboy.sim.cameras.camera_config import CameraConfig, DepthConfig, calibrations_of
from peopleboy.sim.cameras.imaging.camera_view import CameraView, make_material_table
from peopleboy.sim.cameras.kinds import flat_geometry, kind_of
from peopleboy.sim.cameras.rig import Rig
from peopleboy.sim.geometry.pinhole import CameraGeometry, Matrix, Pinhole
from peopleboy.sim.observation import Observation, OnDemand, Senses
from peopleboy.sim.people.crowd import Crowd, Handling
from peopleboy.sim.people.walking.social_force import PlanarState
from peopleboy.sim.physics.kinematic import Kinematic
from peopleboy.sim.physics.physics_engine import Physics
from peopleboy.sim.places.place import Place
from peopleboy.sim.places.textures.texture_place import paint_place
from peopleboy.sim.rendering.full_detail import FullDetail
from peopleboy.sim.rendering.renderer import Renderer, RenderPass, Scene, look
from peopleboy.sim.rendering.view import BLIND, NO_PERSON
from peopleboy.sim.robot.peoplebot import PeopleBot
from peopleboy.sim.robot.robot_body import NAME as ROBOT
from peopleboy.sim.robot.robot_body import RADIUS_M, robot_material
from peopleboy.sim.shapes.materials import Material
from peopleboy.sim.shapes.shape_table import make_shape_table
from peopleboy.sim.shapes.skins import join_skins, pose_skins
from peopleboy.sim.truth.scenes import SCENE, ImageFreeTruth, Records, Scenes, known_people, look_at_people
from peopleboy.sim.truth.truth import BORDER, Box, Truth
from peopleboy.sim.truth.truth_maker import TruthMaker
from peopleboy.sim.world_config import WorldConfig

_STANDS_OUT_K = 5.0  # difference from the surroundings above which objects are drawn in mirrors
_MOST_PEOPLE = 64  # a view's cover has one bit per person


class SimulatedWorld:
    """A world with a robot, people and cameras; use it as a context manager.

    `observe` returns the current sensor readings, and `truth` the ground truth of the same instant. `step`
    advances the world by one control step. The same configuration gives the same bytes in every process.

    Attributes:
        config: the settings.
        crowd: all people.
        robot: the robot, which `step` drives.
        physics: poses and contacts of robot, people and things.
        table, materials, rig: visible shapes, materials of their parts, and the robot's cameras; only in a
            world with images.

    Raises:
        BadInput: names clash, or a part of the world cannot be built.
    """

    def __init__(self, config: WorldConfig) -> None:
        self.config = config
        self._calibrations = calibrations_of(config.robot.cameras)
        self._tick = 0
        self._touching: set[str] = set()
        _check_names(config)
        self.physics = _open_physics(config)
        try:
            self._build()
        except BaseException:
            self.physics.close()
            raise

    def __enter__(self) -> "SimulatedWorld":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Free the physics world; images and truth that were not read before are lost."""
        if self.config.renderer != BLIND:
            self.rig.forget()
        self.physics.close()

    @property
    def cameras(self) -> Mapping[str, CameraConfig]:
        """Settings of the robot's cameras by name."""
        return self.config.robot.cameras

    @property
    def has_images(self) -> bool:
        """Whether there is a renderer."""
        return self.config.renderer != BLIND

    def await_images(self) -> tuple[str, ...]:
        """Return the cameras whose images of this instant are rendered elsewhere; needs a renderer."""
        return self.rig.expect(self._tick)

    @property
    def touching(self) -> tuple[str, ...]:
        """Names of the bodies that the robot touches, except the floor."""
        return tuple(sorted(self._touching)) if self._touching else ()

    @property
    def time_s(self) -> float:
        """Seconds since the start: a whole number of control steps."""
        return self._tick / self.config.control_hz

    def observe(self) -> Observation:
        """Read every sensor once.

        The images are of this instant and are rendered on first access. Call it once per control step: each
        call draws new noise.

        Raises:
            BadInput: the world has no images.
        """
        self._check_sight()
        senses = self.sense()
        return Observation(
            time_s=senses.time_s,
            images=self.take_images(),
            calibrations=self._calibrations,
            sonar_m=senses.sonar_m,
            odometry=senses.odometry,
            wheel_speeds_m_s=senses.wheel_speeds_m_s,
        )

    def take_images(self) -> Mapping[str, NDArray[Any]]:
        """Return the images of this instant, as `observe` does; needs a renderer."""
        return self.rig.read(self._tick)

    def sense(self) -> Senses:
        """Read every sensor except the cameras once; use it instead of `observe` if you need no images."""
        return Senses(
            time_s=self.time_s,
            sonar_m=self.robot.sonar(),
            odometry=self.robot.odometry,
            wheel_speeds_m_s=self.robot.wheel_speeds(),
        )

    def scene(self) -> ImageFreeTruth:
        """Return the ground truth of this instant that needs no image."""
        return self.scenes().truths()[0]

    def scenes(self) -> Scenes:
        """Return the truth of `scene` as arrays, for one world."""
        pose, world_from_robot = self.robot.pose(), self.robot.world_from_robot()
        robot = np.array([pose.x, pose.y, pose.heading])
        worlds, people = np.zeros(1, SCENE), self._bystanders(robot, world_from_robot)
        worlds["time_s"], worlds["robot"], worlds["velocity"] = self.time_s, robot, self.robot.velocity()
        worlds["is_touching"], worlds["end"] = bool(self._touching), len(people)
        return Scenes(worlds, people, (self.crowd.names,), (self.touching,))

    def _bystanders(self, robot: Matrix, world_from_robot: Matrix) -> Records:
        """Return (Q,) records BYSTANDER of present people; the robot's pose is (3,) [m, m, rad], (4, 4)."""
        present = [k for k, person in enumerate(self.crowd.people) if person.present]
        found = self._known_people[present]
        for row, k in zip(found, present, strict=True):
            person = self.crowd.people[k]
            row["position_m"], row["velocity_m_s"] = person.position, person.velocity
            row["heading_rad"] = person.heading
        camera = flat_geometry(self.config.robot.cameras, "thermal")
        cameras = (world_from_robot @ camera.robot_from_camera)[None].repeat(len(present), axis=0)

        def cast(_: NDArray[np.int64], starts: Matrix, ends: Matrix) -> Matrix:
            rays = starts.reshape(-1, 3), ends.reshape(-1, 3)
            return self.physics.cast_rays(*rays, ignore=ROBOT)[0].reshape(starts.shape[:2])

        look_at_people(found, robot[None], camera, cameras, cast)
        return found

    def truth(self, camera: str = "thermal") -> Truth:
        """Return the ground truth of this instant, with boxes and masks in the image of a camera.

        Raises:
            BadInput: there is no camera of that name, or the world has no images.
        """
        if camera not in self.config.robot.cameras:
            known = ", ".join(self.config.robot.cameras)
            raise BadInput(f"unknown camera {camera!r}; choose from {known}")
        seen = self._see(self.config.robot.cameras[camera])
        return self._truth_maker.make(
            time_s=self.time_s,
            seen=seen,
            robot=self.robot.pose(),
            robot_velocity=self.robot.velocity(),
            contacts=self.touching,
        )

    def box(self, person: int) -> Box | None:
        """Return a person's ground-truth box in the thermal image; this is faster than `truth`.

        Args:
            person: number, from 1 in the scenario's order.

        Returns:
            left, top, width, height [px]; None while the person is absent or not in front of the camera.

        Raises:
            BadInput: the world has no images.
        """
        self._check_sight()
        return self._truth_maker.box(person, self._see(self.config.robot.cameras["thermal"]))

    def truths(self) -> Mapping[str, Truth]:
        """Return the truth for each camera that takes an image now; all but `thermal` on first access.

        Raises:
            BadInput: the world has no images; or, on access, the instant is over.
        """
        self._check_sight()
        at_once = {"thermal": self.truth()}
        return OnDemand(self.rig.due(self._tick), partial(self._truth_at, self._tick), at_once)

    def robot_state(self) -> PlanarState:
        """Return the robot's position, velocity, heading and radius, as people perceive it."""
        pose, (speed, _) = self.robot.pose(), self.robot.velocity()
        heading = np.array([np.cos(pose.heading), np.sin(pose.heading)])
        place = np.array([pose.x, pose.y])
        return PlanarState(
            position=place, velocity=speed * heading, radius_m=RADIUS_M, heading_rad=pose.heading
        )

    def step(self, linear_m_s: float, angular_rad_s: float, *, is_emergency: bool = False) -> None:
        """Drive the robot by a velocity command for one control step, and advance people and light.

        In an emergency the robot brakes at higher rates.

        Raises:
            BadInput: the command is not finite.
        """
        self.begin_step(linear_m_s, angular_rad_s, is_emergency=is_emergency)
        touched = set()
        steps = self.config.physics_hz // self.config.control_hz
        for k in range(steps):
            self.robot.drive(1.0 / self.config.physics_hz)
            self.crowd.move_bodies((k + 1) / steps)
            self.physics.step()
            touched |= self.robot.touching()
        self.robot.update_odometry()
        self.end_step(touched)

    def begin_step(self, linear_m_s: float, angular_rad_s: float, *, is_emergency: bool = False) -> None:
        """Apply a command and advance people, whose bodies in the physics world follow later; see `step`.

        Raises:
            BadInput: the command is not finite.
        """
        self.robot.command(linear_m_s, angular_rad_s, is_emergency=is_emergency)
        self.crowd.step(self.time_s, 1.0 / self.config.control_hz, self.robot_state())

    def end_step(self, touched: Collection[str], *, is_settled: bool = False) -> None:
        """Finish a step after physics.

        Args:
            touched: names of the bodies that the robot touched.
            is_settled: whether no person enters or leaves, and all bodies are at their final poses already.
        """
        self._tick += 1
        self._touching = {name.split("/")[0] for name in touched} - {"floor"} if touched else set()
        if is_settled:
            self._forget()
        else:
            self._settle()

    def _build(self) -> None:
        config, physics = self.config, self.physics
        materials = _add_fixtures(physics, config.place)
        self.crowd = Crowd(
            physics,
            config.people,
            config.place,
            config.seed,
            is_visible=config.renderer != BLIND,
            detail=config.detail,
            bodies=config.body_shape,
        )
        self._known_people = known_people(self.crowd.people)
        self._handling = Handling(physics, config.place, self.crowd.people)
        self.robot = PeopleBot(physics, config.robot, config.seed)
        if config.renderer != BLIND:
            self._open_eyes(materials | self.crowd.materials)
        self._settle()

    def _open_eyes(self, materials: dict[str, Material]) -> None:
        """Prepare for images: visible shapes and the appearance of each part, by body name."""
        config, physics = self.config, self.physics
        keys = physics.parts()
        part_materials = [
            robot_material(key.link_name) if key.name == ROBOT else materials[key.name] for key in keys
        ]
        number = {key.name: part for part, key in enumerate(keys)}
        skins = [
            (person.model.skin, [number[key] for key in person.model.part_keys])
            for person in self.crowd.people
            if person.model.skin is not None
        ]
        self.table, self._skins = join_skins(make_shape_table(physics.visual_shapes()), skins)
        paintings = paint_place(config.place, config.seed) if config.detail == "full" else {}
        self.materials = make_material_table(
            part_materials,
            stream(config.seed, "surface.variation"),
            [paintings.get(key.name) for key in keys],
        )
        self._truth_maker = TruthMaker(keys, self.crowd, part_materials, config.place.movers)
        self.is_clear = np.array([material.is_clear for material in part_materials], np.bool_)
        self._is_shiny = self.materials.shine > 0.0
        stands_out = abs(self.materials.thermal[:, 0] - config.place.surroundings_c) > _STANDS_OUT_K
        is_person, glows = self._truth_maker.person_of_part != NO_PERSON, self.materials.colour[:, 6] > 0.0
        self._is_mirrored = is_person | stands_out | glows
        self.rig = Rig(config.robot.cameras, config.control_hz, config.seed, self._camera_view)

    def _settle(self) -> None:
        """Take over the poses of a new instant and clear cached views."""
        self._handling.show(self.time_s)
        self.crowd.show(self.robot.gap_to)
        self._forget()

    def _forget(self) -> None:
        """Clear the cached views of the last instant."""
        if self.config.renderer == BLIND:
            return
        self._scene_now: Scene | None = None
        self._seen: dict[tuple[Renderer, CameraGeometry], RenderPass] = {}
        self._seen_through: dict[tuple[Renderer, CameraGeometry], RenderPass] = {}
        self.rig.forget()

    @property
    def _scene(self) -> Scene:
        """Return the scene of this instant, computed on first access."""
        if self._scene_now is None:
            poses = self.physics.part_poses()
            self._scene_now = Scene(
                renderer=self.config.renderer,
                physics=self.physics,
                table=self.table,
                world_from_part=poses,
                person_of_part=self._truth_maker.person_of_part,
                hidden=self.physics.hidden_parts(),
                skins=None if self._skins is None else pose_skins(self._skins, poses),
            )
        return self._scene_now

    def _check_sight(self) -> None:
        if self.config.renderer == BLIND:
            raise BadInput("renderer 'none': this world has no images; choose raycast or bullet")

    def _truth_at(self, tick: int, camera: str) -> Truth:
        if tick != self._tick:
            raise BadInput(f"camera {camera!r}: the truth of an earlier instant is no longer available")
        return self.truth(camera)

    def _see(self, config: CameraConfig) -> RenderPass:
        """Render one camera's view, at most once per instant.

        Raises:
            BadInput: the world has no images.
        """
        self._check_sight()
        return self._look(config, sees_through=not kind_of(config).senses_heat and bool(self.is_clear.any()))

    def _look(self, config: CameraConfig, *, sees_through: bool) -> RenderPass:
        """Render a camera's view, with or without the surfaces through which light passes."""
        renderer, camera = kind_of(config).renderer, config.camera
        known = self._seen_through if sees_through else self._seen
        if (renderer, camera) not in known:
            pose = self.robot.world_from_robot() @ camera.robot_from_camera
            scene = self._scene.without(self.is_clear) if sees_through else self._scene
            known[renderer, camera] = look(renderer, scene, camera, pose)
        return known[renderer, camera]

    def _glass_cosine(self, config: CameraConfig) -> Matrix | None:
        """Return the cosine of the angle at which a depth camera looks through glass, (H, W), or NaN."""
        if not isinstance(config, DepthConfig) or not self.is_clear.any():
            return None
        solid, camera = self._look(config, sees_through=False), config.camera
        assert isinstance(camera, Pinhole)
        v, u = np.mgrid[0 : camera.height, 0 : camera.width]
        across, down = (
            (u - camera.centre_px[0]) / camera.focal_px,
            (v - camera.centre_px[1]) / camera.focal_px,
        )
        rays = np.stack([across, down, np.ones_like(across)], axis=-1)
        rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
        normals = solid.view.normal @ solid.world_from_camera[:3, :3]
        is_pane = (solid.view.part >= 0) & self.is_clear[solid.view.part]
        return np.where(is_pane, np.abs((rays * normals).sum(axis=-1)), np.nan)

    def _camera_view(self, config: CameraConfig) -> CameraView:
        """Return a sensor's view with everything that image formation needs."""
        seen = self._see(config)
        return CameraView(
            view=seen.view,
            draw=lambda camera: seen.renderer.view(seen.scene, camera, seen.world_from_camera),
            world_from_camera=seen.world_from_camera,
            world_from_part=self._scene.world_from_part,
            materials=self.materials,
            surroundings_c=self.config.place.surroundings_c,
            light_level=light_level(self.config.place, self.time_s),
            turn_rad_s=self.robot.velocity()[1],
            time_s=self.time_s,
            full_detail=self._full_detail(seen),
            glass_cosine=self._glass_cosine(config),
        )

    def _full_detail(self, seen: RenderPass) -> FullDetail | None:
        """Return the extras for images of full detail, for cameras that support it."""
        if self.config.detail == "plain" or not isinstance(seen.camera, Pinhole):
            return None
        return FullDetail(seen, seen.camera, self._is_shiny, self._is_mirrored)


def light_level(place: Place, time_s: float) -> float:
    """Return the level of a place's light at a time: that of the last switch, or full before any."""
    return [1.0, *(level for start, level in place.light if start <= time_s + 1e-9)][-1]


def _open_physics(config: WorldConfig) -> Physics:
    """Open an empty world.

    Raises:
        BadInput: PyBullet is requested and not installed.
    """
    if config.physics == "kinematic":
        return Kinematic(physics_hz=config.physics_hz)
    from peopleboy.sim.physics.bullet import Bullet  # imported here, as kinematic physics needs no PyBullet

    return Bullet(physics_hz=config.physics_hz)


def _check_names(config: WorldConfig) -> None:
    """Refuse people with ambiguous names, and more people than the truth supports."""
    names = [person.name for person in config.people]
    things = {fixture.name.split("/")[0] for fixture in config.place.fixtures}
    for k, name in enumerate(names):
        if "/" in name or name in {ROBOT, BORDER, *things, *names[:k]}:
            raise BadInput(f"person {name!r}: the name is taken or contains '/'; choose another")
    for mover in config.place.movers:
        for by in {action.by for action in mover.actions} - {None, *names}:
            raise BadInput(f"thing {mover.name!r}: moved by unknown person {by!r}")
    if len(names) > _MOST_PEOPLE:
        raise BadInput(f"{len(names)} people are too many; the maximum is {_MOST_PEOPLE}")


def _add_fixtures(physics: Physics, place: Place) -> dict[str, Material]:
    """Add everything static to the physics world; return the appearance by body name."""
    materials = {}
    for fixture in place.fixtures:
        position, orientation = fixture.position, fixture.orientation
        if fixture.part is not None:
            physics.add_part(
                fixture.name,
                fixture.part.shapes,
                position=position,
                orientation=orientation,
                solid=fixture.is_solid,
            )
            materials[fixture.name] = fixture.part.material
        elif fixture.urdf is not None and fixture.material is not None:
            physics.add_urdf(
                fixture.name, fixture.urdf, position=position, orientation=orientation, scale=fixture.scale
            )
            materials[fixture.name] = fixture.material
        else:
            raise BadInput(f"fixture {fixture.name!r} needs either a part or a URDF with a material")
    return materials
