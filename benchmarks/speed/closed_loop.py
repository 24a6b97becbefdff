"""Speed of the closed loop in multiples of real time, and its memory."""

import resource
import tempfile
import time
from pathlib import Path
from statistics import median

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.trackers import DEFAULT_TRACKER, make_tracker

RATE_HZ = 15


def loop_speed(scenario: str, frames: int = 300, *, tracker: str = DEFAULT_TRACKER) -> float:
    """Return the speed of the loop in multiples of real time: world, images, truth, tracker, behaviour."""
    loaded = load_scenario(scenario)
    times = []
    with SimulatedWorld(loaded.world(0)) as world:
        ticks = closed_loop(world, make_tracker(tracker), loaded.make_behaviour(), frames)
        next(ticks)
        last = time.process_time()
        for number, _ in enumerate(ticks, start=1):
            if number % RATE_HZ == 0:
                now = time.process_time()
                times.append(now - last)
                last = now
    # Over whole seconds, since the detector takes longer on some images.
    return 1.0 / median(times)


def run_speed(scenario: str, *, tracker: str = DEFAULT_TRACKER) -> float:
    """Return the speed of a whole `peopleboy run`, including tables, contact sheet and recording."""
    times = []
    last = time.process_time()

    def report(_tick: Tick, _frames: int) -> None:
        nonlocal last
        now = time.process_time()
        times.append(now - last)
        last = now

    with tempfile.TemporaryDirectory() as folder:
        run(load_scenario(scenario), RunOptions(seed=0, out=Path(folder) / "run", tracker=tracker), report)
    # The mean, not the median, since the recording writes only every 15 frames.
    return (len(times) - 1) / RATE_HZ / sum(times[1:])


def peak_memory_mb() -> float:
    """Return the peak memory [MB] of this process."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
