"""Kill commands at random moments: `python -m benchmarks.reliability.kills`.

Each command is run once to its end, then killed by SIGKILL after a random share of that time. Every folder of
a run that it leaves must say what it is and open, as far as it has whole frames; the same command must then
finish, with the bytes of the run that was never killed.
"""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import click
import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks import call
from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import open_run

SCENE: Final = "single_stationary"
COMMANDS: Final = {
    "run": ("run", SCENE, "--tracker", "truth", "--no-recording", "--overwrite"),
    "run --frames": ("run", SCENE, "--tracker", "truth", "--no-recording", "--overwrite", "--frames"),
    "sweep": ("sweep", SCENE, "--tracker", "truth", "--seeds", "2", "--workers", "2"),
    "render": ("render", SCENE, "--seeds", "2", "--workers", "2"),
}
_BEFORE_FIRST: Final = "before its first frame"
_VARY: Final = (".rrd", ".log", ".part")  # suffixes of files that are not compared


@dataclass(slots=True)
class KillResult:
    """What kills of one command came to.

    Attributes:
        command: the command.
        kills: how often it was killed before it had ended.
        faults: what was wrong afterwards.
    """

    command: str
    kills: int
    faults: list[str]


def start(words: Sequence[str], out: Path) -> "subprocess.Popen[bytes]":
    """Start a command in a process group of its own."""
    program = [sys.executable, "-m", "peopleboy", *words, "--out", str(out)]
    return subprocess.Popen(
        program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )


def check_left(out: Path) -> list[str]:
    """Return what is wrong with the folders of runs that a killed command left."""
    faults = []
    for about in out.glob("**/run.json"):
        try:
            run = open_run(about.parent)
            run.files()
            _ = run.events
        except BadInput as error:
            if _BEFORE_FIRST not in str(error):
                faults.append(str(error))
    return faults


def differing(whole: Path, resumed: Path) -> list[str]:
    """Return the files of a folder that are missing in another one, or differ there."""
    names = [path.relative_to(whole) for path in whole.rglob("*") if path.is_file()]
    compared = [name for name in names if name.suffix not in _VARY and name.name != "README.md"]
    return [
        f"{name} differs"
        for name in compared
        if not (resumed / name).is_file() or (whole / name).read_bytes() != (resumed / name).read_bytes()
    ]


def kill_often(name: str, kills: int, folder: Path, rng: np.random.Generator) -> KillResult:
    """Kill a command so often, each time check what it left, and run it to its end."""
    words, whole = COMMANDS[name], folder / "whole" / "out"
    whole.parent.mkdir(parents=True)
    began_s = time.monotonic()
    if start(words, whole).wait() != 0:
        return KillResult(name, 0, ["did not run to its end"])
    lasts_s = time.monotonic() - began_s
    result = KillResult(name, 0, [])
    for number in range(kills):
        out = folder / str(number) / "out"
        out.parent.mkdir()
        process = start(words, out)
        time.sleep(rng.uniform(0.2, 1.0) * lasts_s)
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            result.kills += 1
        process.wait()
        result.faults += check_left(out)
        if start(words, out).wait() != 0:
            result.faults.append(f"kill {number + 1}: did not resume")
        else:
            result.faults += differing(whole, out)
        shutil.rmtree(out.parent)
    return result


@click.command()
@click.option("--kills", default=13, show_default=True, help="Kills of each command.")
@click.option("--command", "names", type=click.Choice(list(COMMANDS)), multiple=True, help="Only these.")
@click.option("--seed", default=0, show_default=True, help="Seed of the moments.")
def main(kills: int, names: tuple[str, ...], seed: int) -> None:
    """Kill commands at random moments, check what they leave, and resume them."""
    rng = np.random.default_rng(seed)
    table = Table("command", "kills", "faults")
    faults = []
    for name in names or COMMANDS:
        with TemporaryDirectory() as folder:
            result = kill_often(name, kills, Path(folder), rng)
        table.add_row(name, str(result.kills), str(len(result.faults)))
        faults += [f"{name}: {fault}" for fault in result.faults]
    Console().print(table)
    for fault in faults[:20]:
        click.echo(fault)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    call(main, "benchmarks.reliability.kills")
