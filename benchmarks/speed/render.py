"""The ray caster against PyBullet's TinyRenderer: both camera images of a corridor, with full truth.

Beside them the ray caster with all that full detail adds, on a polished floor, by an uncooled camera.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.sim.cameras.electronics.thermal_presets import THERMAL_PRESETS
from peopleboy.sim.config import WorldConfig
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.places.rooms import build_place, straight_corridor
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world import World

# (x, y) [m] of the people in front of the robot, who walk on at the same pace.
STARTS_M = ((3.0, 0.4), (4.2, -0.5), (5.5, 0.5), (7.5, -0.2))
RENDERERS = ("raycast", "bullet")
_SHINE = 0.5  # of the floor, where detail is full


@dataclass(frozen=True, slots=True, kw_only=True)
class RenderTimes:
    """Medians over the instants of one run.

    Attributes:
        raycast_ms: [ms] thermal image, colour image and full truth by the ray caster.
        bullet_ms: [ms] the same by TinyRenderer.
        raycast_truth_ms: [ms] of these, one camera's view and its truth by the ray caster.
        bullet_truth_ms: [ms] the same by TinyRenderer.
        full_ms: [ms] both images and full truth by the ray caster with full detail.
        ratio: how many times as long TinyRenderer takes at the same instant as the ray caster for both
            images and the truth, which a machine that is now busy and now idle disturbs less.
        full_ratio: likewise, the ray caster with full detail.
    """

    raycast_ms: float
    bullet_ms: float
    raycast_truth_ms: float
    bullet_truth_ms: float
    full_ms: float
    ratio: float
    full_ratio: float


def render_times(instants: int = 40) -> RenderTimes:
    """Draw the same instants by both renderers in turn, and time each."""
    cases = (*RENDERERS, "full")
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in cases}
    with (
        World(_corridor("raycast")) as cast,
        World(_corridor("bullet")) as drawn,
        World(_polished(_corridor("raycast"))) as full,
    ):
        worlds = dict(zip(cases, (cast, drawn, full), strict=True))
        for _ in range(instants + 2):
            for name, world in worlds.items():
                world.step(0.5, 0.0)
                start = time.process_time()
                world.truth()
                middle = time.process_time()
                dict(world.take_images())  # made only when asked for
                times[name].append((time.process_time() - start, middle - start))
    # The first instants compile the kernels.
    spent_ms = [1000.0 * np.array(times[name][2:]) for name in cases]
    raycast, bullet, finest = (np.median(ms, axis=0) for ms in spent_ms)
    ratio, full_ratio = (np.median(ms[:, 0] / spent_ms[0][:, 0]) for ms in spent_ms[1:])
    return RenderTimes(
        raycast_ms=float(raycast[0]),
        bullet_ms=float(bullet[0]),
        raycast_truth_ms=float(raycast[1]),
        bullet_truth_ms=float(bullet[1]),
        full_ms=float(finest[0]),
        ratio=float(ratio),
        full_ratio=float(full_ratio),
    )


def _corridor(renderer: str) -> WorldConfig:
    people = tuple(
        PersonConfig(name=f"person {i}", path=(Waypoint(at_m=(x, y)), Waypoint(at_m=(x + 10.0, y))))
        for i, (x, y) in enumerate(STARTS_M)
    )
    place = build_place(straight_corridor(20.0, 2.4))
    return WorldConfig(place=place, people=people, renderer=renderer, robot=RobotConfig(at_m=(1.0, 0.0)))


def _polished(config: WorldConfig) -> WorldConfig:
    """The same world in full detail, with a floor that mirrors and all that electronics do to images."""
    cameras = {**config.robot.cameras, "thermal": THERMAL_PRESETS["uncooled"]}
    fixtures = tuple(
        replace(one, part=replace(one.part, material=replace(one.part.material, shine=_SHINE)))
        if one.name == "floor" and one.part is not None
        else one
        for one in config.place.fixtures
    )
    return replace(
        config,
        detail="full",
        place=replace(config.place, fixtures=fixtures),
        robot=replace(config.robot, cameras=cameras),
    )


if __name__ == "__main__":
    found = render_times()
    print(f"two images and truth: raycast {found.raycast_ms:.2f} ms, bullet {found.bullet_ms:.1f} ms")
    print(
        f"one view and truth: raycast {found.raycast_truth_ms:.2f} ms, bullet {found.bullet_truth_ms:.1f} ms"
    )
    print(f"ratio of the two images {found.ratio:.1f}")
    print(f"full detail: {found.full_ms:.2f} ms, {found.full_ratio:.2f} times as long")
