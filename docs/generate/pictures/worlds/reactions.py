"""Plans of the scenarios with reacting people: paths and gaze directions."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np
import pyarrow.parquet as pq
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from docs.generate.pictures.paper import WIDTH_IN
from peopleboy.scenarios.drawing.plan_sheet import Labels, draw_floor, draw_walls
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.sim.people.body.skeleton import JOINT_NAMES

SCENES: Final = {
    "reacts_ignores": "ignores",
    "reacts_makes_way": "makes way",
    "reacts_curious": "curious",
    "reacts_wary": "wary",
    "reacts_blocks": "blocks",
    "reacts_surprised": "surprised",
    "group_keeps_together": "one surprised, the others wait",
    "waits_for_robot": "waits for the robot",
    "calls_robot": "calls the robot",
    "leads_robot": "leads the robot",
}
_ROBOT: Final = "#c0392b"
_FOLLOWED: Final = "#8a8d91"
_COLOURS: Final = ("#0072b2", "#2f7d32", "#b35c00")
_EVERY: Final = 15  # frames between ticks: a second
_TICK_M: Final = 0.55
_NOSE, _EARS = JOINT_NAMES.index("nose"), [JOINT_NAMES.index(f"{side}_ear") for side in ("left", "right")]


def reactions() -> Figure:
    """Draw ten plans: paths, with a dot and a tick for the gaze every second."""
    figure = Figure((WIDTH_IN, 6.3), layout="constrained")
    grid = figure.subplots(3, 4)
    for axes, (name, title) in zip(grid.flat, SCENES.items(), strict=False):
        with TemporaryDirectory() as folder:
            scenario = load_scenario(name)
            out = Path(folder) / "run"
            run(scenario, RunOptions(seed=0, out=out, record=False), lambda *_: None)
            _draw(axes, scenario, out)
        axes.set_title(title, fontsize=11)
    for axes in grid.flat[len(SCENES) :]:
        axes.set_axis_off()
    grid.flat[len(SCENES)].legend(handles=_signs(), loc="center left", frameon=False, fontsize=9)
    return figure


def _draw(axes: Axes, scenario: Scenario, out: Path) -> None:
    draw_floor(axes, scenario.plan)
    draw_walls(axes, Labels(axes), scenario.place)
    robot = pq.read_table(out / "robot.parquet")
    way = np.stack([robot[key].to_numpy() for key in ("x_m", "y_m")], axis=1)
    axes.plot(*way.T, color=_ROBOT, lw=2.0, zorder=6)
    axes.plot(*way[::_EVERY].T, "s", color=_ROBOT, ms=2.6, zorder=6)
    people = pq.read_table(out / "truth.parquet")
    ids = people["id"].to_numpy()
    for number in np.unique(ids):
        is_alone = len(np.unique(ids)) == 1
        is_actor = is_alone or number > 1
        colour = _COLOURS[(number - 1 if is_alone else number - 2) % len(_COLOURS)] if is_actor else _FOLLOWED
        _draw_person(axes, people.filter(ids == number), colour, looks=is_actor)
    low_x, low_y, high_x, high_y = scenario.place.bounds
    axes.set_xlim(low_x, high_x)
    axes.set_ylim(low_y, high_y)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _draw_person(axes: Axes, rows: Any, colour: str, *, looks: bool) -> None:
    at = np.stack([rows[key].to_numpy() for key in ("x_m", "y_m")], axis=1)
    axes.plot(*at.T, color=colour, lw=1.4, zorder=7)
    axes.plot(*at[0], "o", color=colour, ms=6, mec="white", zorder=8)
    if not looks:
        return
    gaze = _gaze(np.array(rows["joints_m"].to_pylist()).reshape(-1, 17, 3))
    for place, direction in zip(at[::_EVERY], gaze[::_EVERY], strict=True):
        axes.plot(*place, "o", color=colour, ms=2.6, zorder=8)
        axes.plot(*np.stack([place, place + _TICK_M * direction]).T, color=colour, lw=1.0, zorder=8)


def _gaze(joints: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return unit vectors (T, 2) on the floor from between the ears to the nose."""
    way = (joints[:, _NOSE] - joints[:, _EARS].mean(axis=1))[:, :2]
    unit: NDArray[np.float64] = way / np.linalg.norm(way, axis=1, keepdims=True)
    return unit


def _signs() -> list[Line2D]:
    return [
        Line2D([], [], color=_ROBOT, lw=2.0, marker="s", ms=3, label="robot, one mark a second"),
        Line2D([], [], color=_FOLLOWED, lw=1.4, marker="o", label="followed person, from the disc on"),
        Line2D([], [], color=_COLOURS[0], lw=1.4, marker="o", label="reacting person"),
        Line2D([], [], color=_COLOURS[0], lw=1.0, label="tick: gaze direction"),
    ]
