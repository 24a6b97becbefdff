"""`python -m benchmarks.physics`: measure how far kinematic physics deviates from PyBullet over the library.

In every scenario whose robot drives and needs no images, the scenario's behaviour drives for 20 s or until it
touches something. It uses the ground truth, or the tracker with `--observation tracks`. There are three
drives: one with PyBullet; one with kinematic physics and the same actions, which gives the deviation of the
path; and one with kinematic physics and its own actions, which gives the deviation of the metrics.
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
        way_m: (N, 2) [m] position of the robot after each step.
        actions: (N, 2).
        touched: object that ended the episode; empty for none.
        following: metrics of person following.
    """

    way_m: NDArray[np.float64]
    actions: NDArray[np.float32]
    touched: tuple[str, ...]
    following: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysicsCase:
    """Result for one scenario.

    Attributes:
        scenario: its name.
        seed: seed of the episodes.
        way_m: [m] length of PyBullet's path.
        off_mm: [mm] largest deviation of the kinematic path with the same actions.
        touched: object that was touched with PyBullet.
        also_touched: object that was touched with kinematic physics and the same actions.
        later_s: [s] delay of that contact; NaN if one drive had no contact.
        following: by metric, the values with PyBullet and with kinematic physics, each with its own actions;
            empty if no person is followed.
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
    """Yield all scenarios of the library whose robots drive and need no images."""
    for name in library():
        scenario = load_scenario(name)
        if scenario.robot.behaviour != "stand" and scenario.robot.walls_by != "image":
            yield scenario


def measure(scenario: Scenario, seed: int, observation: str) -> PhysicsCase:
    """Run the three drives of a scenario."""
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
    """Run an episode with the scenario's behaviour, or with given actions."""
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
    """Summarise all results."""
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
    """Measure, print one line per scenario, and write the results to runs/physics.json.

    The default are all scenarios of the library whose robots drive and need no images.
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
            f"{case.scenario:22s} seed {case.seed}: {case.off_mm:6.1f} mm deviation in {case.way_m:5.1f} m; "
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
