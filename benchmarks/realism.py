"""How well a classifier separates rendered from real thermal images, for each step towards realism.

`python -m benchmarks.realism --chosen CLIP --chosen CLIP --others CLIP --others CLIP` writes the images of
each step, and pages that compare them with the clips, to runs/realism.
"""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import click
from rich.console import Console
from rich.table import Table

from benchmarks import call
from peopleboy.scenarios.files.library import LIBRARY
from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.scenario_file import to_data
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.scenarios.loop.tracker_by_name import make_named_tracker
from peopleboy.scenarios.random_worlds.distribution import narrowed
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.scenarios.run_folder.atomic_output import atomic
from peopleboy.scenarios.run_folder.folder import gt_lines
from peopleboy.scenarios.run_folder.image_files import image_file, write_png
from peopleboy.scenarios.sim_to_real.compare import Separability, compare_images
from peopleboy.scenarios.sim_to_real.page import describe_auc, write_comparison
from peopleboy.sim.world import SimulatedWorld

OUT = Path("runs/realism")
CLIP = click.Path(exists=True, file_okay=False, path_type=Path)
PLAIN = (
    "crossing_3",
    "crowd_8",
    "group_abreast",
    "sitting",
    "stop_and_talk",
    "three_depths",
    "corridor_meeting",
    "crossing_2_moving",
)
STRUCTURED = (
    "warm_office",
    "kitchen_morning",
    "glass_corridor",
    "street_evening",
    "sunny_hall",
    "garage",
    "workshop",
    "crowded_foyer",
)
"""Scenes of the library that imitate real ones."""
WORLDS = 24
STREETS = range(200, 248)
"""Seeds of streets with at least two people, as the clips show them."""
SEED = 100
SCENE_S, WORLD_S = 6.0, 3.0

Data = dict[str, Any]
Change = Callable[[Data], Data]


def _with_camera(**keys: Any) -> Change:
    return lambda data: (
        data
        | {
            "robot": data["robot"]
            | {
                "cameras": data["robot"].get("cameras", {})
                | {"thermal": data["robot"].get("cameras", {}).get("thermal", {"kind": "thermal"}) | keys}
            }
        }
    )


def _in_full(data: Data) -> Data:
    return data | {"detail": "full"}


def _with_capsules(data: Data) -> Data:
    return data | {"bodies": "capsules"}


def _as_it_is(data: Data) -> Data:
    return data


STEPS: dict[str, tuple[Change, ...]] = {
    "fixed span, 24 to 36 degC": (_as_it_is,),
    "automatic gain": (_with_camera(gain="plateau"),),
    "and camera effects": (_with_camera(preset="uncooled_film"),),
    "and full detail": (_with_camera(preset="uncooled_film"), _in_full),
}
"""Changes to the library's older scenes, step by step."""


@click.command()
@click.option("--chosen", multiple=True, required=True, type=CLIP, help="Clip that was used for tuning.")
@click.option("--others", multiple=True, required=True, type=CLIP, help="Clip that was not used for tuning.")
def main(chosen: Sequence[Path], others: Sequence[Path]) -> None:
    """Render every step, compare it with the clips, and print the AUC of patches and of people."""
    table = Table("step", "chosen: all", "people", "others: all", "people", box=None)
    for name, scenarios in steps():
        folder = OUT / name.replace(",", "").replace(" ", "_")
        film(scenarios, folder)
        row = []
        for clips, what in ((chosen, "chosen"), (others, "others")):
            found = compare_images([folder], clips)
            write_comparison(found, OUT / f"{folder.name}_{what}.html")
            row += [describe_auc(found.separability), _words(found.of_people)]
        table.add_row(name, *row)
    Console(width=160).print(table)


def steps() -> Iterator[tuple[str, list[tuple[Scenario, int]]]]:
    """Yield each step with its scenarios and seeds."""
    for name, changes in STEPS.items():
        yield name, [(_changed(scene, changes), SEED) for scene in PLAIN]
    for name, change in {"": _as_it_is, ", people of capsules": _with_capsules}.items():
        yield f"scenes with structure{name}", [(_changed(scene, (change,)), SEED) for scene in STRUCTURED]
        yield f"random worlds{name}", [(_world(seed, change), seed) for seed in range(SEED, SEED + WORLDS)]
    streets = narrowed({"place": "street", "people": [2, 8]})
    yield "random streets", [(random_scenario(seed, WORLD_S, streets), seed) for seed in STREETS]


def _world(seed: int, change: Change) -> Scenario:
    """Return the first seconds of a random world, with a change."""
    data = change(to_data(random_scenario(seed, WORLD_S).spec))
    return parse_scenario(data, source=f"world {seed}", folder=LIBRARY)


def film(scenarios: Sequence[tuple[Scenario, int]], folder: Path) -> None:
    """Write thermal images and boxes of scenarios that have not been rendered yet."""
    for scenario, seed in scenarios:
        clip = folder / f"{scenario.name}-{seed}"
        if not clip.exists():
            with atomic(clip) as part:
                _film(scenario, seed, part)


def _film(scenario: Scenario, seed: int, clip: Path) -> None:
    (clip / "thermal").mkdir(parents=True)
    config = scenario.world(seed)
    frames = round(scenario.duration_s * config.control_hz)
    with SimulatedWorld(config) as world, (clip / "gt.txt").open("w", encoding="utf-8") as truth:
        eyes = make_named_tracker(ORACLE, seed, world.truth)
        for tick in closed_loop(world, eyes, scenario.make_behaviour(), frames):
            write_png(clip / "thermal" / image_file(tick.frame), tick.observation.images["thermal"])
            truth.writelines(gt_lines(tick))


def _changed(name: str, changes: Sequence[Change]) -> Scenario:
    """Return the first seconds of a scene of the library, with changes."""
    data = to_data(load_scenario(name).spec)
    early = [person for person in data["people"] if person.get("enter_s", 0.0) < SCENE_S]
    data |= {"duration_s": SCENE_S, "people": early}
    for change in changes:
        data = change(data)
    return parse_scenario(data, source=name, folder=LIBRARY)


def _words(separability: Separability | None) -> str:
    return "" if separability is None else describe_auc(separability)


if __name__ == "__main__":
    call(main, "benchmarks.realism")
