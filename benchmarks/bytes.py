"""`python -m benchmarks.bytes OTHER_CHECKOUT`: check that two checkouts produce the same bytes.

Images, truth and tracks of ten scenarios are generated with both on this machine, and compared file by file.
A refactoring must not change them.
"""

import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import click
from rich.console import Console
from rich.table import Table

from benchmarks import call

HERE = Path(__file__).parents[1]
STANDING = ("single_stationary", "crossing_3", "crowd_8", "hidden_2s", "dark_crossing", "empty_room")
DRIVING = ("single_follow", "crossing_2_moving", "follow_occluded", "corridor_t_by_image")
IMAGES = ("thermal", "thermal16", "colour")
TEXTS = ("truth/gt.txt", "tracks.txt")


@dataclass(frozen=True, slots=True)
class ByteComparison:
    """Result for one scenario.

    Attributes:
        scenario: its name.
        files: number of compared files.
        differing: names of files that differ, or that only one checkout generated.
    """

    scenario: str
    files: int
    differing: tuple[str, ...]


def compare_folders(scenario: str, ours: Path, theirs: Path) -> ByteComparison:
    """Compare images, truth and tracks of two runs byte by byte."""
    names = sorted(set(_files(ours)) | set(_files(theirs)))
    return ByteComparison(scenario, len(names), tuple(n for n in names if not _is_same(ours / n, theirs / n)))


def compare_checkouts(
    scenarios: Sequence[str], other: Path, folder: Path, seed: int = 0, workers: int = 2
) -> list[ByteComparison]:
    """Run each scenario with this checkout and with another one, and compare the files.

    Raises:
        click.ClickException: a checkout has no environment, or a run failed.
    """
    programs = {"here": _program(HERE), "there": _program(other)}

    def compare(name: str) -> ByteComparison:
        for side, program in programs.items():
            _play(program, name, seed, folder / side / name)
        return compare_folders(name, folder / "here" / name, folder / "there" / name)

    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(compare, scenarios))


def _program(checkout: Path) -> Path:
    program = checkout.resolve() / ".venv" / "bin" / "peopleboy"
    if not program.is_file():
        raise click.ClickException(f"{checkout}: no .venv/bin/peopleboy; run `make .venv/.ready` in it")
    return program


def _play(program: Path, scenario: str, seed: int, out: Path) -> None:
    command = [program, "run", scenario, "--seed", str(seed), "--frames", "--no-recording", "--out", out]
    done = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, cwd=out.anchor, check=False
    )
    if done.returncode:
        raise click.ClickException(f"{program} run {scenario}: {done.stderr.strip()}")


def _files(run: Path) -> list[str]:
    images = [path for kind in IMAGES for path in (run / kind).glob("*.png")]
    return [path.relative_to(run).as_posix() for path in [*images, *(run / name for name in TEXTS)]]


def _is_same(one: Path, other: Path) -> bool:
    return one.is_file() and other.is_file() and one.read_bytes() == other.read_bytes()


@click.command()
@click.argument(
    "other", type=click.Path(exists=True, file_okay=False, path_type=Path), metavar="OTHER_CHECKOUT"
)
@click.option(
    "--scenarios", default=",".join((*STANDING, *DRIVING)), show_default=True, help="Scenarios, by name."
)
@click.option("--seed", default=0, show_default=True, help="Seed of all runs.")
@click.option("--workers", default=2, show_default=True, help="Number of parallel scenarios.")
def main(other: Path, scenarios: str, seed: int, workers: int) -> None:
    """Compare images, truth and tracks of OTHER_CHECKOUT with this one; exit with 1 if they differ."""
    table = Table("scenario", "files", "differ", box=None)
    with TemporaryDirectory() as folder:
        found = compare_checkouts(scenarios.split(","), other, Path(folder), seed, workers)
    for one in found:
        first = f" ({one.differing[0]} ...)" if one.differing else ""
        table.add_row(one.scenario, str(one.files), f"{len(one.differing)}{first}")
    Console(width=100).print(table)
    sys.exit(1 if any(one.differing for one in found) else 0)


if __name__ == "__main__":
    call(main, "benchmarks.bytes")
