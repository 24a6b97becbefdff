"""CPU time of full detail: both camera images with full ground truth, compared with plain detail.

`python -m benchmarks.speed.full_detail [SCENARIO...]` prints a row for each scenario, by descending cost; the
default are all scenarios of the library in full detail. `--renderers` instead compares the ray caster, in
plain and in full detail, with TinyRenderer in a corridor with four people. `--bodies` compares people of
capsules with skins, in both details; the default is crossing_4.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final

import click
from rich.console import Console
from rich.table import Table

from benchmarks import call
from benchmarks.compare import Turns, spent_ms
from peopleboy.behaviours.behaviour import Command
from peopleboy.scenarios.files.library import LIBRARY, library
from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.scenario_file import to_data
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.scenarios.loop.tracker_by_name import make_named_tracker
from peopleboy.sim.cameras.kinds import THERMAL_PRESETS
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.places.make_place import build_place
from peopleboy.sim.places.place_config import straight_corridor
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig

PLAIN, FULL = "plain", "full"
RAYCAST, BULLET = "raycast", "bullet"
CAPSULES: Final = "capsules"
SKINS: Final = "skins"
TRUTH = ", truth"  # suffix: only one view and its truth
PRESET = "uncooled"  # electronics of the thermal camera in full detail, unless the scenario has its own
SEED = 0
COMPILED = 2  # instants after which all kernels are compiled

# (x, y) [m] of the people in front of the robot, who walk at its speed.
STARTS_M = ((3.0, 0.4), (4.2, -0.5), (5.5, 0.5), (7.5, -0.2))
_SHINE = 0.5  # reflectance of the floor in full detail


def detail_times(name: str, instants: int | None = None) -> Turns:
    """Run a scenario of the library in both details, in turn at each instant, and time them [ms].

    Timed are thermal image, colour image and full truth: `plain` with a fixed gain, and `full` with the
    electronics of an uncooled camera.

    Args:
        name: name of the scenario.
        instants: number of instants; None for all.

    Raises:
        BadInput: unknown scenario.
    """
    plain, full = in_detail(name, PLAIN), in_detail(name, FULL)
    commands = _commands(full, instants)
    with SimulatedWorld(plain.world(SEED)) as plain_world, SimulatedWorld(full.world(SEED)) as full_world:
        return _timed({PLAIN: plain_world, FULL: full_world}, commands)


def body_times(name: str, detail: str, instants: int | None = None) -> Turns:
    """Run a scenario with people of capsules and with skins, as `detail_times` does with both details."""
    scenario = in_detail(name, detail)
    commands, world = _commands(scenario, instants), scenario.world(SEED)
    with (
        SimulatedWorld(replace(world, bodies=CAPSULES)) as capsules,
        SimulatedWorld(replace(world, bodies=SKINS)) as skins,
    ):
        return _timed({CAPSULES: capsules, SKINS: skins}, commands)


def render_times(instants: int = 40) -> Turns:
    """Time TinyRenderer and the ray caster in plain and full detail, in turn, on a corridor [ms].

    Names with the suffix `TRUTH` include one camera's view and its truth; the others include both images.
    """
    with (
        SimulatedWorld(_corridor(RAYCAST)) as cast,
        SimulatedWorld(_corridor(BULLET)) as drawn,
        SimulatedWorld(_polished(_corridor(RAYCAST))) as full,
    ):
        ahead = Command(linear_m_s=0.5, angular_rad_s=0.0)
        for world in (cast, drawn, full):
            world.step(ahead.linear_m_s, ahead.angular_rad_s)
        return _timed({RAYCAST: cast, BULLET: drawn, FULL: full}, [ahead] * (instants + COMPILED))


def _timed(worlds: Mapping[str, SimulatedWorld], commands: Sequence[Command]) -> Turns:
    turns = Turns()
    for number, command in enumerate(commands):
        turn = {}
        for name, world in worlds.items():
            turn[f"{name}{TRUTH}"] = spent_ms(world.truth)
            # Images are rendered lazily.
            turn[name] = turn[f"{name}{TRUTH}"] + spent_ms(partial(_all_images, world))
            world.step(command.linear_m_s, command.angular_rad_s)
        if number >= COMPILED:
            turns.add(turn)
    return turns


def _all_images(world: SimulatedWorld) -> dict[str, Any]:
    return dict(world.take_images())


def in_detail(name: str, detail: str) -> Scenario:
    """Load a scenario of the library in a detail, with matching electronics of the thermal camera."""
    data: dict[str, Any] = to_data(load_scenario(name).spec)
    robot = data.get("robot", {})
    cameras = robot.get("cameras", {})
    electronics = {"preset": PRESET} | cameras.get("thermal", {}) if detail == FULL else {}
    robot |= {"cameras": cameras | {"thermal": {"kind": "thermal"} | electronics}}
    return parse_scenario(data | {"detail": detail, "robot": robot}, source=name, folder=LIBRARY)


def _commands(scenario: Scenario, instants: int | None) -> list[Command]:
    """Return the robot's commands in a scenario, so that both worlds are seen from the same positions."""
    config = scenario.world(SEED)
    frames = round(scenario.duration_s * config.control_hz) if instants is None else instants + COMPILED
    with SimulatedWorld(config) as world:
        ticks = closed_loop(
            world, make_named_tracker(ORACLE, SEED, world.truth), scenario.make_behaviour(), frames
        )
        return [tick.command for tick in ticks]


def _corridor(renderer: str) -> WorldConfig:
    people = tuple(
        PersonConfig(name=f"person {i}", path=(Waypoint(at_m=(x, y)), Waypoint(at_m=(x + 10.0, y))))
        for i, (x, y) in enumerate(STARTS_M)
    )
    place = build_place(straight_corridor(20.0, 2.4))
    return WorldConfig(place=place, people=people, renderer=renderer, robot=RobotConfig(at_m=(1.0, 0.0)))


def _polished(config: WorldConfig) -> WorldConfig:
    """Change a world to full detail, with a reflecting floor and all effects of electronics."""
    cameras = {**config.robot.cameras, "thermal": THERMAL_PRESETS[PRESET]}
    fixtures = tuple(
        replace(one, part=replace(one.part, material=replace(one.part.material, shine=_SHINE)))
        if one.name == "floor" and one.part is not None
        else one
        for one in config.place.fixtures
    )
    place, robot = replace(config.place, fixtures=fixtures), replace(config.robot, cameras=cameras)
    return replace(config, detail=FULL, place=place, robot=robot)


def _renderer_lines() -> Iterator[str]:
    found = render_times()
    for title, end in (("two images and truth", ""), ("one view and truth", TRUTH)):
        cast_ms, drawn_ms = (found.median(f"{name}{end}") for name in (RAYCAST, BULLET))
        yield f"{title}: raycast {cast_ms:.2f} ms, bullet {drawn_ms:.1f} ms"
    yield f"ratio of the two images {found.ratio(BULLET, RAYCAST):.1f}"
    yield f"full detail: {found.median(FULL):.2f} ms, {found.ratio(FULL, RAYCAST):.2f} times as long"


def _body_lines(names: Sequence[str], instants: int | None) -> Iterator[str]:
    for name in names or ["crossing_4"]:
        for detail in (PLAIN, FULL):
            found = body_times(name, detail, instants)
            capsules_ms, skins_ms = found.median(CAPSULES), found.median(SKINS)
            times = f"{found.ratio(SKINS, CAPSULES):.2f} times as long"
            yield f"{name}, {detail}: capsules {capsules_ms:.2f} ms, skins {skins_ms:.2f} ms, {times}"


@click.command()
@click.argument("scenarios", nargs=-1)
@click.option("--instants", type=click.IntRange(1), help="Number of timed instants.  [default: all]")
@click.option("--renderers", is_flag=True, help="Compare renderers in a corridor instead.")
@click.option("--bodies", is_flag=True, help="Compare the shapes of people instead.")
def main(scenarios: Sequence[str], instants: int | None, *, renderers: bool, bodies: bool) -> None:
    """Print CPU times of SCENARIOS in plain and in full detail; the default are all in full detail."""
    if renderers or bodies:
        for line in _renderer_lines() if renderers else _body_lines(scenarios, instants):
            click.echo(line)
        return
    names = scenarios or [name for name in library() if load_scenario(name).spec.detail == FULL]
    times = {name: detail_times(name, instants) for name in names}
    table = Table("scenario", "plain, ms", "full, ms", "times as long", box=None)
    for name, found in sorted(times.items(), key=lambda item: -item[1].ratio(FULL, PLAIN)):
        row = (found.median(PLAIN), found.median(FULL), found.ratio(FULL, PLAIN))
        table.add_row(name, *(f"{value:.2f}" for value in row))
    Console(width=100).print(table)


if __name__ == "__main__":
    call(main, "benchmarks.speed.full_detail")
