"""`python -m benchmarks.physics`: how far kinematic physics are from PyBullet's, over the library.

In every scenario whose robot drives without images, and is not to stand, the scenario's own behaviour drives
by the truth, or by the tracker with `--observation tracks`, for 20 s or until it touches something: with
PyBullet; again
by the same actions, without it, which tells how far the way is off; and once more without it by itself, which
tells how far the figures are.
"""

import json
import math
import sys
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from benchmarks import call
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.written_controller import WrittenController
from peopleboy.scenarios.files.library import library
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.scenarios.files.scenario import Scenario

COMPARED_S = 20.0
FIGURES = ("in_band", "facing", "in_band_and_facing", "followed")
FOLLOWERS = ("follow_person", "patrol")
OUT = Path("runs") / "physics.json"


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """One episode.

    Attributes:
        way_m: (N, 2) [m] where the robot was after each step.
        actions: (N, 2).
        touched: what it ended at, empty for nothing.
        following: the figures of how a person was followed.
    """

    way_m: NDArray[np.float64]
    actions: NDArray[np.float32]
    touched: tuple[str, ...]
    following: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysicsCase:
    """What came of one scenario.

    Attributes:
        scenario: its name.
        seed: of the episodes.
        way_m: [m] how long PyBullet's way was.
        off_mm: [mm] how far the other way was from it at most, by the same actions.
        touched: what PyBullet's robot touched.
        also_touched: what the other one touched by the same actions.
        later_s: [s] by how much later it did; NaN if one of them touched nothing.
        following: by name, PyBullet's share and the other's, each driving by itself; empty where nobody is
            followed.
    """

    scenario: str
    seed: int
    way_m: float
    off_mm: float
    touched: tuple[str, ...]
    also_touched: tuple[str, ...]
    later_s: float
    following: dict[str, tuple[float, float]]


def drivers() -> Iterator[Scenario]:
    """Yield all scenarios of the library whose robots drive without looking at images themselves."""
    for name in library():
        scenario = load_scenario(name)
        if scenario.robot.behaviour != "stand" and scenario.robot.walls_by != "image":
            yield scenario


def measure(scenario: Scenario, seed: int, observation: str) -> PhysicsCase:
    """Drive three times."""
    theirs = drive(scenario, seed, observation, "bullet")
    again = drive(scenario, seed, observation, "kinematic", theirs.actions)
    steps = min(len(theirs.way_m), len(again.way_m))
    off = np.linalg.norm(theirs.way_m[:steps] - again.way_m[:steps], axis=1)
    both = theirs.touched and again.touched
    following = {}
    if scenario.robot.behaviour in FOLLOWERS:
        alone = drive(scenario, seed, observation, "kinematic")
        following = {name: (theirs.following[name], alone.following[name]) for name in FIGURES}
    return PhysicsCase(
        scenario=scenario.name,
        seed=seed,
        way_m=float(np.linalg.norm(np.diff(theirs.way_m[:steps], axis=0), axis=1).sum()),
        off_mm=1e3 * float(off.max()),
        touched=theirs.touched,
        also_touched=again.touched,
        later_s=(len(again.way_m) - len(theirs.way_m)) / 15 if both else math.nan,
        following=following,
    )


def drive(
    scenario: Scenario,
    seed: int,
    observation: str,
    physics: str,
    actions: NDArray[np.float32] | None = None,
) -> Drive:
    """Play an episode by a scenario's own behaviour, or by given actions."""
    eyes = ORACLE if observation == "truth" else None
    env = PeopleBoyEnv(scenario.name, observation=observation, tracker=eyes, physics=physics)
    controller = WrittenController(scenario.make_behaviour())
    way, done, touched, following = [], [], (), {}
    with closing(env):
        seen, _ = env.reset(seed=seed)
        most = round(COMPARED_S * 15) if actions is None else len(actions)
        is_over = False
        while not is_over and len(done) < most:
            action = controller(seen) if actions is None else actions[len(done)]
            seen, _, terminated, truncated, info = env.step(action)
            done.append(action)
            way.append((info["truth"].robot.x, info["truth"].robot.y))
            touched, is_over = info["truth"].contacts, terminated or truncated
        following = env.metrics()["following"]
    return Drive(np.array(way), np.array(done), touched, following)


def summary(cases: Sequence[PhysicsCase]) -> dict[str, float]:
    """Return what all came to."""
    off = [case.off_mm for case in cases]
    changes = [
        abs(ours - theirs)
        for case in cases
        for theirs, ours in case.following.values()
        if not math.isnan(ours - theirs)
    ]
    either = [case for case in cases if case.touched or case.also_touched]
    return {
        "episodes": len(cases),
        "way_m": sum(case.way_m for case in cases),
        "off_mm": float(np.median(off)),
        "worst_off_mm": max(off),
        "contacts": len(either),
        "same_contacts": sum(case.touched == case.also_touched for case in either),
        "figures": len(changes),
        "change": float(np.mean(changes)) if changes else math.nan,
        "worst_change": max(changes, default=math.nan),
    }


@click.command()
@click.argument("scenarios", metavar="[SCENARIO]...", nargs=-1)
@click.option("--observation", type=click.Choice(["truth", "tracks"]), default="truth", show_default=True)
@click.option("--seeds", type=click.IntRange(min=1), default=1, show_default=True)
def main(scenarios: Sequence[str], observation: str, seeds: int) -> None:
    """Measure, print a line each, and keep the figures in runs/physics.json.

    Without a scenario, those of the library are taken whose robots drive without images.
    """
    chosen = [load_scenario(name) for name in scenarios] or list(drivers())
    episodes = [(scenario, seed) for scenario in chosen for seed in range(seeds)]
    cases = []
    for scenario, seed in episodes:
        case = measure(scenario, seed, observation)
        cases.append(case)
        shares = ", ".join(f"{name} {a:.3f} {b:.3f}" for name, (a, b) in case.following.items())
        touched = "/".join(",".join(names) or "nothing" for names in (case.touched, case.also_touched))
        click.echo(
            f"{case.scenario:22s} seed {case.seed}: {case.off_mm:6.1f} mm off in {case.way_m:5.1f} m; "
            f"touched {touched}; {shares}"
        )
        sys.stdout.flush()
    found = summary(cases)
    click.echo(json.dumps(found, indent=2))
    OUT.parent.mkdir(exist_ok=True)
    kept = json.loads(OUT.read_text("utf-8")) if OUT.is_file() else {}
    kept[observation] = found | {"cases": [asdict(case) for case in cases]}
    OUT.write_text(json.dumps(kept, indent=1), encoding="utf-8")


if __name__ == "__main__":
    call(main, "benchmarks.physics")
