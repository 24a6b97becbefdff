"""Growth of memory: of a tracker over 100 000 frames with changing people, and of an environment over resets.

The frames of one scenario are repeated with advancing time; with `--world` they are rendered anew in a new
world each time.
"""

import ctypes
import gc
import os
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing
from dataclasses import dataclass, replace
from itertools import chain, count, islice, repeat
from multiprocessing import get_context
from pathlib import Path

import click
import numpy as np

from benchmarks import call
from benchmarks.speed.contour_tracker import STEP_S, shoot
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.trackers import DEFAULT_TRACKER, make_tracker

SCENARIO = "hall_visits"
SAMPLES = 20
WARM_UP = 0.25  # share of the frames before growth is measured


@dataclass(frozen=True, slots=True, kw_only=True)
class MemoryCurve:
    """Resident memory over a long run.

    Attributes:
        frame: (S,) frame numbers.
        resident_mb: (S,) [MB] resident memory after them.
        people: total number of initiated tracks.
    """

    frame: tuple[int, ...]
    resident_mb: tuple[float, ...]
    people: int

    @property
    def bytes_per_frame(self) -> float:
        """Growth of memory after warm-up: the slope over the later samples."""
        warm = [at > WARM_UP * self.frame[-1] for at in self.frame]
        frame, held = np.array(self.frame)[warm], np.array(self.resident_mb)[warm]
        return float(np.polyfit(frame, 1e6 * held, 1)[0])


def memory_curve(frames: Iterable[Frame], length: int) -> MemoryCurve:
    """Track a number of frames, and sample the memory."""
    tracker = make_tracker(DEFAULT_TRACKER)
    at, held, people = [], [], 0
    for number, frame in enumerate(islice(frames, length), 1):
        tracks = tracker.update(frame)
        people = max([people, *(track.id for track in tracks)])
        if number * SAMPLES // length > (number - 1) * SAMPLES // length:
            at.append(number)
            held.append(resident_mb())
    return MemoryCurve(frame=tuple(at), resident_mb=tuple(held), people=people)


def long_run(frames: int, *, renders: bool = False) -> MemoryCurve:
    """Measure the memory curve in a separate process, where no other code allocates or frees memory."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        return process.submit(_run, frames, renders=renders).result()


def _run(frames: int, *, renders: bool) -> MemoryCurve:
    return memory_curve(endless_frames(renders=renders), frames)


def resident_mb() -> float:
    """Return the resident memory [MB] of this process (Linux with the GNU C library).

    Freed memory is returned to the system first, since it could hide growth for long.
    """
    ctypes.CDLL(None).malloc_trim(0)
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def endless_frames(*, renders: bool = False) -> Iterator[Frame]:
    """Yield the scenario's frames repeatedly with advancing time, cached or rendered in new worlds."""
    rounds = (shoot(SCENARIO) for _ in count()) if renders else repeat(list(shoot(SCENARIO)))
    for number, frame in enumerate(chain.from_iterable(rounds)):
        yield replace(frame, time_s=number * STEP_S)


def reset_growth(resets: int) -> float:
    """Return the growth of memory per reset [bytes], measured in a separate process."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        return process.submit(_reset_growth, resets).result()


def _reset_growth(resets: int) -> float:
    with closing(PeopleBoyEnv("single_follow", observation="truth")) as env:
        # The C library's pool of free memory grows during the first hundred.
        for seed in range(max(resets, 100)):
            env.reset(seed=seed)
        before_mb = _held_mb()
        for seed in range(resets):
            env.reset(seed=seed)
        return 1e6 * (_held_mb() - before_mb) / resets


def _held_mb() -> float:
    gc.collect()
    return resident_mb()


@click.command()
@click.option("--frames", default=100_000, show_default=True)
@click.option("--world", "renders", is_flag=True, help="Render each repetition in a new world.")
def main(frames: int, *, renders: bool) -> None:
    """Track, and print the memory curve."""
    curve = long_run(frames, renders=renders)
    for frame, held in zip(curve.frame, curve.resident_mb, strict=True):
        click.echo(f"{frame:8d} frames  {held:7.1f} MB")
    click.echo(f"{curve.people} tracks initiated; growth {curve.bytes_per_frame:.0f} bytes per frame")


if __name__ == "__main__":
    call(main, "benchmarks.speed.memory")
