"""A run once more: its world built again and the robot driven by the commands that it was given then.

The images are not kept unless a run is asked to, and the masks never are; but the same scenario, seed and
versions give the same bytes. No tracker is needed for that: commands and tracks are those of the run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import count

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import Command
from peopleboy.scenarios.loop.faults import FaultySensors
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.run_folder.run_tables import Row, truth_rows

Play = Callable[[FinishedRun], Iterator[Tick]]

# What must come out as it was; a hundredth of a pixel is what the labels promise.
_COMPARED = ("id", "x_m", "y_m", "left_px", "top_px", "width_px", "height_px", "visible_px", "whole_px")
_TOLERANCE = 0.01


def replay(run: FinishedRun) -> Iterator[Tick]:
    """Yield the ticks of a finished run, with images and masks, and explanations as far as it kept them.

    Raises:
        BadInput: the world does not come out as it was in the run, or PyBullet is not installed.
    """
    from peopleboy.sim.world import World  # here, as what is written can be exported without PyBullet

    files = run.files()
    tracks, people = files.tracks_by_frame(), files.people_by_frame()
    explanations = files.explanations_by_frame(run.about.tracker)
    with World(run.world) as world:
        stage = FaultySensors(world, run.scenario.spec.faults, run.robot.sonar.farthest_m)
        for row in files.robot.to_pylist():
            frame = row["frame"]
            command = _command(row)
            tick = Tick(
                frame=frame,
                observation=stage.observe(),
                truths=stage.truths(),
                tracks=tuple(tracks[frame]),
                explanation=explanations[frame],
                mode=row["mode"],
                command=command,
            )
            _compare(tick, row, people.get(frame, []), run)
            yield tick
            if frame < run.frames:
                stage.step(command.linear_m_s, command.angular_rad_s, is_emergency=command.is_emergency)


def counted(report: Callable[[int], None]) -> Play:
    """Return a `replay` that reports each tick by its number, counted on over all runs."""
    number = count(1)

    def play(run: FinishedRun) -> Iterator[Tick]:
        for tick in replay(run):
            report(next(number))
            yield tick

    return play


def _command(row: Row) -> Command:
    return Command(
        linear_m_s=row["command_linear_m_s"],
        angular_rad_s=row["command_angular_rad_s"],
        is_emergency=row["command_is_emergency"],
    )


def _compare(tick: Tick, robot: Row, people: Sequence[Row], run: FinishedRun) -> None:
    pose = tick.truth.robot
    was, now = (robot["x_m"], robot["y_m"], robot["heading_rad"]), (pose.x, pose.y, pose.heading)
    is_same = np.allclose(was, now, rtol=0.0, atol=_TOLERANCE) and np.array_equal(
        *_aligned(_numbers(people), _numbers(truth_rows(tick)))
    )
    if not is_same:
        raise BadInput(
            f"{run.folder}: frame {tick.frame} does not come out as in this run{_why(run)}; run it again"
        )


def _aligned(
    was: NDArray[np.float64], now: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return both with what is within the tolerance made equal."""
    if was.shape != now.shape:
        return was, now
    is_close = np.isclose(was, now, rtol=0.0, atol=_TOLERANCE, equal_nan=True)
    return np.where(is_close, 0.0, was), np.where(is_close, 0.0, now)


def _numbers(rows: Sequence[Row]) -> NDArray[np.float64]:
    table = [[np.nan if row[name] is None else row[name] for name in _COMPARED] for row in rows]
    return np.array(table, np.float64).reshape(len(rows), len(_COMPARED))


def _why(run: FinishedRun) -> str:
    """Name the packages that have changed since."""
    before, now = run.about.versions, versions()
    changed = [f"{name} {was}, now {now[name]}" for name, was in before.items() if now.get(name, was) != was]
    return f" (made with {'; '.join(changed)})" if changed else ""
