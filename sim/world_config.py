"""The settings of a world: place, people and robot."""

from dataclasses import dataclass, field

from peopleboy.bad_input import BadInput, found_in
from peopleboy.sim.cameras.kinds import check_rate
from peopleboy.sim.people.person_config import BodyShape, PersonConfig
from peopleboy.sim.physics.physics_engine import PHYSICS, PhysicsName, default_physics
from peopleboy.sim.places.place import Place
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.shapes.materials import Detail

CONTROL_HZ = 15  # [Hz] default rate of commands and images


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldConfig:
    """A whole world, ready to be built.

    Attributes:
        place: walls, floor and things.
        people: the people in it.
        robot: the robot and its sensors.
        seed: seed of every random stream in the world.
        physics_hz: [Hz] steps of the physics engine.
        control_hz: [Hz] commands and images.
        renderer: "raycast" or "bullet"; "none" for a world without images, which is several times faster.
        physics: "bullet", PyBullet's dynamics; or "kinematic", rolling without slip, which needs no PyBullet.
        bodies: "capsules", or "skins" for people with the bodies of children, adults and elders; None for
            what suits the detail, see `body_shape`.
        detail: "plain", or "full" for finely drawn people and surfaces, which make images harder.

    Raises:
        BadInput: a control step is not a whole number of physics steps, or an image period not one of
            control steps; the seed is negative; physics is unknown or lacks that renderer.
    """

    place: Place
    people: tuple[PersonConfig, ...] = ()
    robot: RobotConfig = field(default_factory=RobotConfig)
    seed: int = 0
    physics_hz: int = 240
    control_hz: int = CONTROL_HZ
    renderer: str = "raycast"
    physics: PhysicsName = field(default_factory=default_physics)
    detail: Detail = "plain"
    bodies: BodyShape | None = None

    def __post_init__(self) -> None:
        """Refuse rates that do not divide each other, and invalid seeds."""
        if self.control_hz <= 0 or self.physics_hz % self.control_hz:
            raise BadInput(
                f"control rate {self.control_hz} Hz must divide the physics rate {self.physics_hz} Hz: "
                "a control step is a whole number of physics steps"
            )
        for name, camera in self.robot.cameras.items():
            with found_in("cameras", name):
                check_rate(camera.rate_hz, self.control_hz)
        if self.physics not in PHYSICS:
            raise BadInput(f"unknown physics {self.physics!r}; choose from {', '.join(PHYSICS)}")
        if self.renderer == "bullet" and self.physics != "bullet":
            raise BadInput(f"renderer 'bullet' needs physics bullet, not {self.physics}; choose raycast")
        if self.renderer == "bullet" and self.bodies == "skins":
            raise BadInput("renderer 'bullet' cannot draw skins; choose raycast, or bodies: capsules")
        if self.seed < 0:
            raise BadInput(f"seed {self.seed} must be 0 or more")

    @property
    def body_shape(self) -> BodyShape:
        """The shape of people: with full detail skins, if another one is not set and skins can be drawn."""
        if self.bodies is not None:
            return self.bodies
        return "skins" if self.detail == "full" and self.renderer != "bullet" else "capsules"
