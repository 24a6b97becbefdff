"""Steps per second with one camera of a robot among people, compared with a drone with vision in PyBullet.

The drone's world is rebuilt after gym-pybullet-drones, which is not in a package index: `HoverAviary` with
image observations and 48 commands per second. A drone of 27 g hovers with four propellers over a plane with a
block, a cube, a duck and a teddy bear. Physics runs at 240 Hz, and TinyRenderer renders 64 x 48 pixels of
colour, depth and segmentation with shadows for every second command. TinyRenderer takes longest for the
drone's mesh, so the mesh here has as many triangles. Only forces, pose and images are computed.

Source: Panerati et al., Learning to Fly, a Gym Environment with PyBullet Physics, 2021, and its code, 2.0.
"""

from contextlib import closing
from dataclasses import dataclass
from itertools import product
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from benchmarks.compare import Turns
from benchmarks.speed.environments import ACTION, MANY, QUICK_HZ, RUN_HZ, SCENARIO, WARM_UP, steps_per_s
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.vector_environment import PeopleBoyVectorEnv
from peopleboy.sim.physics.bullet import Bullet

Corners = NDArray[np.float64]  # (V, 3) [m], drone frame
Triangles = NDArray[np.int64]  # (T, 3) numbers of corners

SIZE: Final = (64, 48)
CONTROL_HZ: Final = 48
COMMANDS_AN_IMAGE: Final = 2  # 24 images per second
_MASS_KG, _ARM_M, _RADIUS_M, _HEIGHT_M = 0.027, 0.0397, 0.06, 0.025
_START_M = (0.0, 0.0, 0.1125)
_NEAR_M, _FAR_M, _FOV_DEG = _ARM_M, 1000.0, 60.0
_PROPELLERS_M = tuple((x, y, 0.0) for x in (0.028, -0.028) for y in (0.028, -0.028))
_LANDMARKS: Final = {
    "block.urdf": (1.0, 0.0, 0.1),
    "cube_small.urdf": (0.0, 1.0, 0.1),
    "duck_vhacd.urdf": (-1.0, 0.0, 0.1),
    "teddy_vhacd.urdf": (0.0, -1.0, 0.1),
}
CASES: Final = (
    ("bullet", RUN_HZ, 1),
    ("bullet", QUICK_HZ, 1),
    ("kinematic", QUICK_HZ, 1),
    ("kinematic", QUICK_HZ, MANY),
)
_ROUNDS: Final = 3
_DRONE, _WATCHER = "every second image", "every image"
_LINK_FRAME, _BASE = 1, -1  # as PyBullet numbers them
_CYLINDER, _MESH = 4, 5


@dataclass(frozen=True, slots=True)
class Prism:
    """An upright prism, with 4 triangles per side except for 4.

    Attributes:
        sides: at least 3.
        radius_m, height_m: its size [m].
        centre_m: [m] drone frame.
    """

    sides: int
    radius_m: float
    height_m: float
    centre_m: tuple[float, float, float]


_ARMS_M: Final = tuple(product((0.0326, -0.0326), repeat=2))
# The parts of cf2.dae, which has 9434 triangles; these prisms have 9424.
PARTS: Final = (
    *(Prism(199, 0.023, 0.001, (x, y, 0.012)) for x, y in _ARMS_M),  # propellers
    *(Prism(38, 0.0035, 0.015, (x, y, 0.0)) for x, y in _ARMS_M),  # motors
    *(Prism(83, 0.005, 0.008, (x, y, 0.0)) for x, y in _ARMS_M),  # their mounts
    *(Prism(10, 0.003, 0.003, (0.8 * x, 0.8 * y, 0.0)) for x, y in _ARMS_M),  # arms
    Prism(301, 0.014, 0.002, (0.0, 0.0, 0.0)),  # circuit board
    Prism(14, 0.012, 0.002, (0.0, 0.0, -0.003)),
    Prism(4, 0.012, 0.004, (0.0, 0.0, 0.004)),
    *(Prism(4, 0.01, 0.002, (0.0, y, 0.003)) for y in (-0.01, 0.01)),  # headers
    *(Prism(38 - pin % 2, 0.0005, 0.01, (0.001 * (pin - 10), 0.01, 0.003)) for pin in range(20)),
)


def drone_mesh() -> tuple[Corners, Triangles]:
    """Return the mesh of all parts."""
    corners, triangles, start = [], [], 0
    for prism in PARTS:
        ends, faces = _mesh_of(prism)
        corners.append(ends)
        triangles.append(faces + start)
        start += len(ends)
    return np.concatenate(corners), np.concatenate(triangles)


def _mesh_of(prism: Prism) -> tuple[Corners, Triangles]:
    sides = prism.sides
    turn = 2.0 * np.pi * np.arange(sides) / sides
    ring = prism.radius_m * np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=1)
    up = np.array([0.0, 0.0, prism.height_m / 2.0])
    corners = np.concatenate([ring - up, ring + up]) + prism.centre_m
    one, fan = np.arange(sides), np.arange(1, sides - 1)
    other, hub = (one + 1) % sides, np.zeros_like(fan)
    faces = [(one, other, other + sides), (one, other + sides, one + sides), (hub, fan + 1, fan)]
    faces.append((hub + sides, fan + sides, fan + 1 + sides))
    return corners, np.concatenate([np.stack(face, axis=1) for face in faces])


class DroneWorld:
    """A hovering drone with a front camera among landmarks; a context manager."""

    def __init__(self) -> None:
        self._physics = Bullet(physics_hz=RUN_HZ)
        client = self._client = self._physics._client
        for name, position in {"plane.urdf": (0.0, 0.0, 0.0), **_LANDMARKS}.items():
            self._physics.add_urdf(name, name, position=position, fixed=name == "plane.urdf")
        solid = client.createCollisionShape(_CYLINDER, radius=_RADIUS_M, height=_HEIGHT_M)
        corners, triangles = drone_mesh()
        shape = client.createVisualShape(_MESH, vertices=corners.tolist(), indices=triangles.ravel().tolist())
        self._drone = client.createMultiBody(_MASS_KG, solid, shape, _START_M)
        self._lift_n = (0.0, 0.0, _MASS_KG * 9.81 / len(_PROPELLERS_M))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._physics.close()

    def step(self) -> None:
        """Simulate one command."""
        for _ in range(RUN_HZ // CONTROL_HZ):
            for place in _PROPELLERS_M:
                self._client.applyExternalForce(self._drone, _BASE, self._lift_n, place, _LINK_FRAME)
            self._client.applyExternalTorque(self._drone, _BASE, (0.0, 0.0, 0.0), _LINK_FRAME)
            self._client.stepSimulation()
        self._client.getBaseVelocity(self._drone)

    def see(self) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """Render colours (48, 64, 4), depth (48, 64) and segmentation (48, 64)."""
        client = self._client
        place, orientation = map(np.array, client.getBasePositionAndOrientation(self._drone))
        x, y, z, w = orientation
        ahead = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)])
        eye, target = place + np.array([0.0, 0.0, _ARM_M]), place + _FAR_M * ahead
        view = client.computeViewMatrix(eye, target, (0.0, 0.0, 1.0))
        lens = client.computeProjectionMatrixFOV(_FOV_DEG, 1.0, _NEAR_M, _FAR_M)
        _, _, colours, depth, parts = client.getCameraImage(*SIZE, view, lens, shadow=1)
        width, height = SIZE
        shape = (height, width)
        return np.reshape(colours, (*shape, 4)), np.reshape(depth, shape), np.reshape(parts, shape)


@dataclass(frozen=True, slots=True, kw_only=True)
class DroneRates:
    """Environment steps per second of CPU time.

    Attributes:
        drone_s: rate of the drone's world with an image for every second step, as in its environment.
        drone_images_s: rate of the drone's world with an image for every step.
        ours_s: rates of PeopleBoy with an image of one camera for every step, by physics, physics rate [Hz]
            and number of worlds in the process, summed over worlds.
        ratios: ratios of `ours_s` to `drone_s`.
    """

    drone_s: float
    drone_images_s: float
    ours_s: dict[tuple[str, int, int], float]
    ratios: dict[tuple[str, int, int], float]


def drone_rates() -> DroneRates:
    """Measure all rates in turn, several times, and return the medians."""
    turns = Turns()
    for _ in range(_ROUNDS):
        turn = {_DRONE: drone_rate(COMMANDS_AN_IMAGE), _WATCHER: drone_rate(1)}
        turns.add(turn | {str(case): pixels_rate(*case) for case in CASES})
    return DroneRates(
        drone_s=turns.median(_DRONE),
        drone_images_s=turns.median(_WATCHER),
        ours_s={case: turns.median(str(case)) for case in CASES},
        ratios={case: turns.ratio(str(case), _DRONE) for case in CASES},
    )


def drone_rate(commands_an_image: int, steps: int = 120) -> float:
    """Return the steps per second of CPU time of the drone's world."""
    with DroneWorld() as world:

        def step(number: int) -> None:
            world.step()
            if number % commands_an_image == 0:
                world.see()

        return steps_per_s(step, steps, warm_up=WARM_UP)


def pixels_rate(physics: str, physics_hz: int, worlds: int, rounds: int = 200) -> float:
    """Return the same for environments with images of one camera of the same size."""
    options: dict[str, Any] = {
        "scenario": SCENARIO,
        "observation": "pixels",
        "image_size": SIZE,
        "cameras": ("thermal",),
        "physics": physics,
        "physics_hz": physics_hz,
    }
    env = PeopleBoyEnv(**options) if worlds == 1 else PeopleBoyVectorEnv(worlds, **options)
    action = np.tile(np.array(ACTION, np.float32), (worlds, 1) if worlds > 1 else 1)
    with closing(env):
        env.reset(seed=0)
        return worlds * steps_per_s(lambda _: env.step(action), rounds, warm_up=WARM_UP)


def main() -> None:
    """Measure, and print one line per case."""
    found = drone_rates()
    print(f"a drone with vision: {found.drone_s:.0f} steps/s, an image for every second step")
    print(f"a drone with vision: {found.drone_images_s:.0f} steps/s, an image for every step")
    for case, rate in found.ours_s.items():
        physics, physics_hz, worlds = case
        print(
            f"ours, one camera, {physics} at {physics_hz} Hz, worlds: {worlds}: {rate:.0f} steps/s, "
            f"{found.ratios[case]:.2f} times as many"
        )


if __name__ == "__main__":
    main()
