"""Record the drives of a suite: `python -m peopleboy.scenarios.running.record_drives dataset2`.

A robot that follows people depends on its tracker. To give all trackers the same frames of a data set, the
contour tracker drives the robot once, and its commands are stored.
"""

import sys
from collections.abc import Iterator

from peopleboy.behaviours.behaviour import Command
from peopleboy.scenarios.files.recorded_drives import write_drive
from peopleboy.scenarios.files.suite import SuiteRun, drive_path, load_suite, runs_of
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.trackers import CONTOUR_TRACKER, make_tracker


def record(run: SuiteRun) -> Iterator[Command]:
    """Run a scenario of a suite with the contour tracker, and yield the robot's command at each step."""
    config = run.scenario.world(run.seed)
    tracker = make_tracker(CONTOUR_TRACKER, run.seed)
    frames = run.scenario.frames
    with SimulatedWorld(config) as world:
        for tick in closed_loop(world, tracker, run.scenario.make_behaviour(), frames):
            yield tick.command


def main(suite: str) -> None:
    """Record all missing drives of a suite."""
    for run in runs_of(load_suite(suite), with_drives=False):
        path = drive_path(suite, run.scenario.name, run.seed)
        if not path.exists():
            write_drive(path, list(record(run)))
            print(path)


if __name__ == "__main__":
    main(*sys.argv[1:])
