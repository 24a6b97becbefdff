"""`python -m benchmarks.peers`: compare peers and PeopleBoy's trackers on the occlusion scenarios."""

from pathlib import Path

import click

from peopleboy.bad_input import BadInput

try:
    import trackers as _trackers  # noqa: F401
except ImportError as error:
    raise SystemExit("benchmarks.peers: the package trackers is missing; `make peers` installs it") from error

from benchmarks import call
from benchmarks.compare import compare
from benchmarks.peers.compete import Result, SequenceTask
from benchmarks.peers.contestants import contestants
from benchmarks.peers.show import draw_occlusions, print_occlusions, print_results, write_results
from peopleboy.scenarios.commands.command_options import workers_options
from peopleboy.scenarios.files.suite import load_suite
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.wording import hint

_QUICK = "crossing_2,crossing_3,same_uniform,pass_behind_pillar,hidden_0_5s,hidden_2s,hidden_5s,crowd_8"
_USUAL = (
    "detection,contour,thesis,hog_colour+bytetrack,hog_thermal+bytetrack,hog_thermal+sort,"
    "blobs+bytetrack,blobs+sort,oracle+bytetrack"
)


@click.command()
@click.option("--scenarios", default=_QUICK, show_default=True, help="Names, or 'all' of suite occlusion.")
@click.option(
    "--seeds", type=click.IntRange(min=1), default=1, show_default=True, help="Number of seeds, from 0 on."
)
@click.option("--trackers", default=_USUAL, show_default=True, help="Names of trackers.")
@workers_options
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs/peers"),
    show_default=True,
    help="Output folder and cache.",
)
def main(scenarios: str, seeds: int, trackers: str, workers: Workers, out: Path) -> None:
    """Run peers and PeopleBoy's trackers on the same frames, and print their metrics."""
    names = trackers.split(",")
    for name in names:
        if name not in contestants():
            raise BadInput(f"--trackers: unknown {name!r}; {hint(name, contestants())}")
    played = (
        [entry.scenario for entry in load_suite("occlusion").runs]
        if scenarios == "all"
        else scenarios.split(",")
    )
    results = _compete_all(names, played, seeds, workers, out)
    print_results(results)
    click.echo()
    print_occlusions(results)
    write_results(results, out / "results.json")
    click.echo()
    for path in draw_occlusions(results, out):
        click.echo(path)


def _compete_all(
    names: list[str], played: list[str], seeds: int, workers: Workers, out: Path
) -> dict[str, list[Result]]:
    """Run sequence by sequence, so that each is rendered by one process only."""
    tasks = {
        (shot, seed): [SequenceTask(tuple(names), shot, seed, out.resolve())]
        for shot in played
        for seed in range(seeds)
    }
    found = [results for (results,) in compare(tasks, workers, "films").values()]
    return {name: [results[k] for results in found] for k, name in enumerate(names)}


if __name__ == "__main__":
    call(main, "benchmarks.peers")
