"""Draw the plan of a scenario: the place, warm objects, walking paths with times, and the robot's view."""

import textwrap
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Final

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from peopleboy.bad_input import BadInput, Key
from peopleboy.scenarios.drawing.plan_paths import COLOUR, draw_moves, draw_person, draw_robot
from peopleboy.scenarios.drawing.plan_sheet import (
    INK,
    PAPER,
    SPAN_C,
    WARMTH,
    Labels,
    draw_floor,
    draw_things,
    draw_walls,
    lay_out,
    name_things,
    sections,
)
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.run_folder.atomic_output import write_aside, writing_to
from peopleboy.sim.world_config import WorldConfig

_PERSON, _ROBOT, _FAULT = "#1f6fb4", "#c0392b", "#e00000"
_TIMES: Final = "Times hold for people who walk undisturbed; people who give way to others arrive later."


def draw_legend(figure: Figure, side_in: float, *, has_moves: bool) -> None:
    """Draw the legend at the foot of a plan; symbols of moved objects only if the plan has any."""
    width, height = figure.get_size_inches()
    figure.legend(
        handles=[*_signs(), *([_ghost()] if has_moves else [])],
        loc="lower left",
        bbox_to_anchor=(side_in / width, 0.24 / height),
        ncols=3,
        fontsize=7.5,
        frameon=False,
        labelcolor=INK,
        borderaxespad=0.0,
        handlelength=2.2,
        columnspacing=1.6,
    )
    figure.text(side_in / width, 0.12 / height, _TIMES, size=7.5, color=INK, va="center")


def _ghost() -> Artist:
    label = "where an object is moved to, the time, and the person who moves it"
    return Patch(facecolor="none", edgecolor=COLOUR, ls=(0, (2, 1.5)), label=label)


def _signs() -> list[Artist]:
    def mark(sign: str, label: str, colour: str = _PERSON, **more: object) -> Line2D:
        settings: dict[str, object] = {"marker": sign, "color": colour, "linestyle": "none", "markersize": 6}
        return Line2D([], [], label=label, **(settings | more))  # type: ignore[arg-type]

    return [
        mark("o", "a person's start, name, height, arrival and departure", markeredgecolor="white"),
        mark("o", "where the person is at that time", linestyle="-", markerfacecolor="white", markersize=4),
        mark("s", "end of the path: stays, leaves, or the run ends", markeredgecolor="white", markersize=5),
        mark("o", "a pause on the path", markerfacecolor="none", markersize=9),
        mark(">", "the robot's start", _ROBOT),
        Line2D(
            [], [], color=_ROBOT, ls=(0, (4, 2)), lw=1.4, label="its scripted path; distances of 3 and 10 m"
        ),
        Patch(facecolor=_ROBOT, alpha=0.14, label="initial field of view; darker: people are counted"),
        Patch(facecolor="none", edgecolor="#d2592f", ls=(0, (3, 2)), label="hangs overhead, or a lintel"),
    ]


_PEOPLE = ("#1f6fb4", "#2f7d32", "#7b3fa0", "#a8327a", "#00798c", "#5d4a1f", "#9a6700", "#4a4a4a", "#6d7500")
_WIDTH_IN, _HEAD_IN, _FOOT_IN, _SIDE_IN, _DPI = 11.0, 0.85, 1.3, 0.25, 130
_BAR_IN = 0.9  # room for the temperature scale on the right


def draw_plan(scenario: Scenario, seed: int, path: Path, faults: Sequence[Key] = ()) -> None:
    """Draw a scenario as it is played with a seed, and save the picture.

    Args:
        scenario: what to draw.
        seed: seed of the variations.
        path: file of the picture, such as plan.png.
        faults: keys of values that are wrong; those that are places are marked with their numbers from 1.
    """
    config = scenario.world(seed)
    figure = Figure(dpi=_DPI, facecolor=PAPER)
    FigureCanvasAgg(figure)
    found = lay_out(
        figure,
        sections(scenario.place.bounds),
        _WIDTH_IN,
        head_in=_HEAD_IN,
        foot_in=_FOOT_IN,
        side_in=(_SIDE_IN, _SIDE_IN + _BAR_IN),
    )
    for axes in found:
        _draw_section(axes, scenario, config)
        _mark_faults(axes, scenario, faults)
    _caption(figure, scenario, seed)
    _temperatures(figure, found)
    draw_legend(figure, _SIDE_IN, has_moves=bool(scenario.place.movers))
    with writing_to(path):
        if not path.parent.exists():
            path.parent.mkdir(parents=True)
        try:
            if not path.suffix:  # matplotlib would append one
                raise ValueError("it has no suffix")
            figure.savefig(picture := BytesIO(), dpi=_DPI, format=path.suffix[1:])
        except ValueError as error:
            raise BadInput(
                f"{path}: cannot write the plan: {error}; give a path that ends in .png"
            ) from error
        write_aside(path, picture.getvalue())


def _draw_section(axes: Axes, scenario: Scenario, config: WorldConfig) -> None:
    labels = Labels(axes)
    draw_floor(axes, scenario.plan)
    draw_walls(axes, labels, scenario.place)
    draw_robot(axes, labels, scenario, config.robot)
    draw_things(axes, labels, scenario.place)
    draw_moves(axes, labels, scenario.place)
    for index, person in enumerate(config.people):
        draw_person(axes, labels, person, scenario.duration_s, _PEOPLE[index % len(_PEOPLE)])
    name_things(labels, scenario.place)


def _mark_faults(axes: Axes, scenario: Scenario, faults: Sequence[Key]) -> None:
    """Mark wrong places with a ring and their number; those outside the floor at its border."""
    min_x, min_y, max_x, max_y = scenario.place.bounds
    shared: dict[tuple[float, float], list[str]] = {}
    for number, key in enumerate(faults, start=1):
        place = _place_at(scenario, key)
        if place is not None:
            x, y = min(max(place[0], min_x), max_x), min(max(place[1], min_y), max_y)
            shared.setdefault((x, y), []).append(str(number))
    for (x, y), numbers in shared.items():
        axes.plot(x, y, "o", mfc="none", mec=_FAULT, ms=15, mew=2.0, zorder=9)
        style = {"boxstyle": "circle,pad=0.2", "fc": _FAULT, "ec": "white"}
        beside = axes.annotate(
            ",".join(numbers), (x, y), (11, 11), textcoords="offset points", size=8, color="white", bbox=style
        )
        beside.set_zorder(10)


def _place_at(scenario: Scenario, key: Key) -> tuple[float, float] | None:
    """Return the place [m] that a key of the scenario file leads to; None if it leads elsewhere."""
    value: object = scenario.spec
    try:
        for step in key:
            value = value[step] if isinstance(step, int) else getattr(value, step)  # type: ignore[index]
    except (AttributeError, IndexError, TypeError):
        return None
    is_place = bool(key) and key[-1] == "at_m" and isinstance(value, tuple)
    return value if is_place else None  # type: ignore[return-value]


def _caption(figure: Figure, scenario: Scenario, seed: int) -> None:
    height = figure.get_figheight()
    left = _SIDE_IN / _WIDTH_IN
    figure.text(left, 1.0 - 0.26 / height, scenario.name, size=15, weight="bold", color=INK, va="center")
    about = textwrap.fill(scenario.description, 140)
    figure.text(left, 1.0 - 0.5 / height, about, size=8.5, color=INK, va="top", linespacing=1.35)
    lights = ", ".join(f"{100.0 * light.level:g} % at {light.at_s:g} s" for light in scenario.spec.lights)
    facts = [f"seed {seed}", f"{scenario.duration_s:g} s", f"robot: {scenario.robot.behaviour}"]
    note = "   ·   ".join([*facts, *([f"light: {lights}"] if lights else [])])
    figure.text(1.0 - left, 1.0 - 0.26 / height, note, size=8.5, color=INK, va="center", ha="right")


def _temperatures(figure: Figure, found: list[Axes]) -> None:
    """Draw the temperature scale of objects beside the plan."""
    top, bottom = found[0].get_position().y1, found[-1].get_position().y0
    height = min(0.85 * (top - bottom), 3.5 / figure.get_figheight())
    bar = figure.add_axes((1.0 - 0.72 / _WIDTH_IN, (top + bottom - height) / 2.0, 0.12 / _WIDTH_IN, height))
    figure.colorbar(ScalarMappable(SPAN_C, WARMTH), cax=bar, extend="both")
    bar.set_title("objects, °C", size=8, color=INK)
    bar.tick_params(labelsize=7, colors=INK)
