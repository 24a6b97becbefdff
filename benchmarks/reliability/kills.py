"""Kill commands at random moments: `python -m benchmarks.reliability.kills`.

Each command is run to its end twice: the first run compiles kernels, the second shows the processor time. It
is then killed by SIGKILL after a random share of that time. Every folder of a run that it leaves must say
what it is and open, as far as it has whole frames, and have lost at most the frame in flight. The same
command must then finish, with the bytes of the run that was never killed.
"""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import click
import numpy as np

from benchmarks import call
from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import open_run, read_run

SCENE: Final = "crossing_2"
COMMANDS: Final[dict[str, tuple[str, ...]]] = {
    "run": ("run", SCENE, "--tracker", "truth", "--no-recording", "--overwrite"),
    "run --frames": ("run", SCENE, "--tracker", "truth", "--no-recording", "--overwrite", "--frames"),
    "sweep": ("sweep", SCENE, "--tracker", "truth", "--seeds", "2", "--workers", "2"),
    "render": ("render", SCENE, "--seeds", "2", "--workers", "2"),
    "track": ("track", "{run}/thermal", "--overwrite"),
    "export": ("export", "{run}", "--format", "coco", "--overwrite"),
    "reproduce": ("reproduce", "figure-4.4", "--quick", "--workers", "1"),
    "train": ("train", "distance", "room_long", "--seeds", "2", "--epochs", "5", "--workers", "1"),
}
"""Commands by name; {run} is a run with images that is made before."""

_HEAD: Final = "command       kills  cut-off runs opened  most frames lost  faults"
_ROW: Final = "{:12}  {:5}  {:19}  {:16}  {:6}"
_STEP_S: Final = 0.05
_EARLIEST: Final = 0.4  # share of the processor time, most of which imports take
_BEFORE_FIRST: Final = "before its first frame"
_VARY: Final = (".rrd", ".log", ".part")  # suffixes of files that are not compared
_TIMED: Final = (
    "README.md",
    "run.json",
    "index.html",
    "units.jsonl",
    "latency.txt",
)  # have times of the clock


@dataclass(slots=True)
class KillResult:
    """What kills of one command came to.

    Attributes:
        command: the command.
        kills: how often it was killed before it had ended.
        left: runs that were cut off, and opened afterwards.
        lost: most frames that one of them had lost.
        faults: what was wrong afterwards.
    """

    command: str
    kills: int = 0
    left: int = 0
    lost: int = 0
    faults: list[str] = field(default_factory=list)


def start(words: Sequence[str], out: Path) -> "subprocess.Popen[bytes]":
    """Start a command in a process group of its own."""
    program = [sys.executable, "-m", "peopleboy", *words, "--out", str(out)]
    return subprocess.Popen(
        program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )


def members(group: int) -> Iterator[list[str]]:
    """Yield the fields of /proc/PID/stat, from the state on, of the living processes of a group."""
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            words = path.read_text(encoding="utf-8").rpartition(")")[2].split()
            # A process whose first thread has ended keeps its files open until its last one has.
            has_threads = words[0] != "Z" or len(list(path.with_name("task").iterdir())) > 1
            if int(words[2]) == group and has_threads:
                yield words


def spent_s(group: int) -> float:
    """Return the processor time [s] of a group of processes, which other load does not change."""
    return sum(sum(map(int, words[11:15])) for words in members(group)) / os.sysconf("SC_CLK_TCK")


def kill(process: "subprocess.Popen[bytes]") -> None:
    """Kill a command and its workers, and wait until the last of them has gone."""
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    while any(members(process.pid)):
        time.sleep(_STEP_S)


def measure_s(words: Sequence[str], out: Path) -> float:
    """Run a command to its end, and return its processor time [s]."""
    process, takes_s = start(words, out), 0.0
    while process.poll() is None:
        takes_s = max(takes_s, spent_s(process.pid))
        time.sleep(_STEP_S)
    if process.returncode != 0:
        raise click.ClickException(f"{words[0]} did not run to its end")
    return takes_s


def last_frame(folder: Path) -> int:
    """Return the last frame that a killed run began, from its text files; 0 for none."""
    lines = [
        line
        for path in (*folder.glob("truth/*gt.txt"), folder / "tracks.txt")
        if path.is_file()
        for line in path.read_text(encoding="utf-8").split("\n")[:-1]
    ]
    return max((int(line.partition(",")[0]) for line in lines), default=0)


def check_left(out: Path, result: KillResult) -> None:
    """Check the folders of runs that a killed command left."""
    for about in out.glob("**/run.json"):
        begun = last_frame(about.parent)
        try:
            said = read_run(about.parent)
            if "footage" in said:
                continue
            run = open_run(about.parent)
            run.files()
            _ = run.events
        except BadInput as error:
            if _BEFORE_FIRST not in str(error):
                result.faults.append(str(error))
            continue
        if run.incomplete:
            result.left += 1
            result.lost = max(result.lost, begun - run.frames)


def differing(whole: Path, resumed: Path) -> list[str]:
    """Return the files of a folder that are missing in another one, or differ there."""
    names = [path.relative_to(whole) for path in whole.rglob("*") if path.is_file()]
    compared = [name for name in names if name.suffix not in _VARY and name.name not in _TIMED]
    return [
        f"{name} differs"
        for name in compared
        if not (resumed / name).is_file() or (whole / name).read_bytes() != (resumed / name).read_bytes()
    ]


def kill_often(name: str, kills: int, folder: Path, rng: np.random.Generator) -> KillResult:
    """Kill a command so often, each time check what it left, and run it to its end."""
    run, whole, result = folder / "run", folder / "whole" / "out", KillResult(name)
    words = [word.format(run=run) for word in COMMANDS[name]]
    if words != list(COMMANDS[name]) and start(COMMANDS["run --frames"], run).wait() != 0:
        raise click.ClickException("the run with images failed")
    for out in (folder / "first" / "out", whole):
        out.parent.mkdir(parents=True)
        takes_s = measure_s(words, out)
    for number in range(kills):
        out = folder / str(number) / "out"
        out.parent.mkdir()
        process, until_s = start(words, out), rng.uniform(_EARLIEST, 1.0) * takes_s
        while process.poll() is None and spent_s(process.pid) < until_s:
            time.sleep(_STEP_S)
        if process.poll() is None:
            kill(process)
            result.kills += 1
        check_left(out, result)
        if start(words, out).wait() != 0:
            result.faults.append(f"kill {number + 1}: did not resume")
        else:
            result.faults += differing(whole, out)
        left = [path.name for path in out.parent.iterdir() if path != out]
        result.faults += [f"kill {number + 1}: left {name}" for name in left]
        shutil.rmtree(out.parent)
    return result


@click.command()
@click.option("--kills", default=8, show_default=True, help="Kills of each command.")
@click.option("--command", "names", type=click.Choice(list(COMMANDS)), multiple=True, help="Only these.")
@click.option("--seed", default=0, show_default=True, help="Seed of the moments.")
def main(kills: int, names: tuple[str, ...], seed: int) -> None:
    """Kill commands at random moments, check what they leave, and resume them."""
    rng = np.random.default_rng(seed)
    faults = []
    click.echo(_HEAD)
    for name in names or COMMANDS:
        with TemporaryDirectory() as folder:
            result = kill_often(name, kills, Path(folder), rng)
        click.echo(_ROW.format(name, result.kills, result.left, result.lost, len(result.faults)))
        faults += [f"{name}: {fault}" for fault in result.faults]
    for fault in faults[:20]:
        click.echo(fault)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    call(main, "benchmarks.reliability.kills")
