"""Compare the learned follower with the scripted one in worlds that were not used for training.

Both use the tracker's output, which was not used for training either.

    python -m examples.learning.evaluate                   # scenarios that were not used for training
    python -m examples.learning.evaluate --new-seeds       # other worlds of the training scenarios
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click
from rich.console import Console

from examples.learning.follower import LearnedFollower, load_weights
from examples.learning.worlds import LEARNED_ON, NEVER_SEEN
from examples.show import Figures, play, print_figures, summary
from peopleboy.behaviours.behaviour import Behaviour
from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.behaviours.safety_guard import Guarded
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.written_controller import WrittenController

PHYSICS_HZ = 60  # a quarter of a run's; the path deviates by millimetres


def compare(
    policy: Path, scenarios: Sequence[str], eyes: str, seeds: Sequence[int], console: Console
) -> dict[str, list[Figures]]:
    """Run both in the same worlds with the same safety guard, and print their rewards."""
    weights = load_weights(policy)
    runs: dict[str, list[Figures]] = {"learned": [], "written": []}
    for scenario in scenarios:
        env = PeopleBoyEnv(scenario, observation=eyes, physics_hz=PHYSICS_HZ)
        for seed in seeds:
            drivers: dict[str, Behaviour] = {
                "learned": Guarded(LearnedFollower(weights)),
                "written": make_behaviour("follow_person"),
            }
            for name, behaviour in drivers.items():
                runs[name].append(play(env, WrittenController(behaviour), seed))
            earned = ", ".join(f"{name} {played[-1]['reward']:.1f}" for name, played in runs.items())
            console.print(f"{scenario}, seed {seed}: {earned}")
        env.close()
    return runs


def as_json(runs: dict[str, list[Figures]]) -> dict[str, Any]:
    """Return the metrics by controller, for JSON."""
    return {
        "runs": len(runs["learned"]),
        **{
            name: {figure: asdict(found) for figure, found in of_one.items()} for name, of_one in _named(runs)
        },
    }


def _named(runs: dict[str, list[Figures]]) -> Iterator[tuple[str, Any]]:
    """Yield the summaries, with the key `difference` for the differences."""
    for name, of_one in summary(runs).items():
        yield ("difference" if " - " in name else name), of_one


@click.command()
@click.option(
    "--policy",
    type=click.Path(path_type=Path),
    default=LearnedFollower.file,
    help="File of weights.  [default: those of the repository]",
)
@click.option("--new-seeds", is_flag=True, help="Use the training scenarios with other seeds.")
@click.option("--seeds", type=click.IntRange(min=1), default=5, show_default=True, help="Seeds per scenario.")
@click.option("--first-seed", type=click.IntRange(min=0), default=1000, show_default=True)
@click.option("--eyes", type=click.Choice(["tracks", "truth"]), default="tracks", show_default=True)
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), help="JSON file for all metrics.")
def main(policy: Path, new_seeds: bool, seeds: int, first_seed: int, eyes: str, out: Path | None) -> None:
    """Compare the learned follower with the scripted one, and print metrics with 95 % intervals."""
    console = Console(width=110)
    scenarios = LEARNED_ON if new_seeds else NEVER_SEEN
    runs = compare(policy, scenarios, eyes, range(first_seed, first_seed + seeds), console)
    print_figures(
        f"{', '.join(scenarios)}; on {eyes}; {len(runs['learned'])} worlds: mean [95 % interval]",
        runs,
        console,
    )
    if out is not None:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(json.dumps(as_json(runs), indent=2), encoding="utf-8")


if __name__ == "__main__":
    main()
