"""`python -m benchmarks.peers`: peers and our trackers on the same frames of the occlusion library."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import click
from rich.console import Console
from rich.progress import track

from peopleboy.bad_input import BadInput

try:
    import trackers as _trackers  # noqa: F401
except ImportError as error:
    raise SystemExit("benchmarks.peers: the package trackers is missing; `make peers` installs it") from error

from benchmarks.peers.compete import Result, compete_on_film
from benchmarks.peers.contestants import contestants
from benchmarks.peers.show import draw_occlusions, print_occlusions, print_results, write_results
from peopleboy.scenarios.files.schema_errors import hint
from peopleboy.scenarios.files.suite import load_suite

_QUICK = "crossing_2,crossing_3,same_uniform,pass_behind_pillar,hidden_0_5s,hidden_2s,hidden_5s,crowd_8"
_USUAL = (
    "peopleboy,thesis,hog_colour+bytetrack,hog_thermal+bytetrack,hog_thermal+sort,"
    "blobs+bytetrack,blobs+sort,oracle+bytetrack"
)


@click.command()
@click.option("--scenarios", default=_QUICK, show_default=True, help="Names, or 'all' of suite occlusion.")
@click.option(
    "--seeds", type=click.IntRange(min=1), default=1, show_default=True, help="How many, from 0 on."
)
@click.option("--trackers", default=_USUAL, show_default=True, help="Names of contestants.")
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="At the same time.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs/peers"),
    show_default=True,
    help="What is kept.",
)
def main(scenarios: str, seeds: int, trackers: str, jobs: int, out: Path) -> None:
    """Let peers and our trackers see the same frames, and print how they do."""
    names = trackers.split(",")
    for name in names:
        if name not in contestants():
            raise BadInput(f"--trackers: unknown {name!r}; {hint(name, contestants())}")
    played = (
        [entry.scenario for entry in load_suite("occlusion").runs]
        if scenarios == "all"
        else scenarios.split(",")
    )
    console = Console(width=130)
    results = _compete_all(names, played, seeds, jobs, out)
    print_results(results, console)
    console.print()
    print_occlusions(results, console)
    write_results(results, out / "results.json")
    draw_occlusions(results, out / "occlusions.png")
    console.print(f"\n{out / 'occlusions.png'}")


def _compete_all(
    names: list[str], played: list[str], seeds: int, jobs: int, out: Path
) -> dict[str, list[Result]]:
    """Film by film, so that each is rendered by one process only."""
    films = [(scenario, seed) for scenario in played for seed in range(seeds)]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        waiting = [pool.submit(compete_on_film, names, *shot, out) for shot in films]
        done = [future.result() for future in track(waiting, "films", console=Console(stderr=True))]
    return {name: [results[k] for results in done] for k, name in enumerate(names)}


if __name__ == "__main__":
    try:
        main(standalone_mode=False)
    except (BadInput, click.ClickException) as error:
        raise SystemExit(f"benchmarks.peers: {error}") from error
