"""`make bench`: how fast everything is, from one run; leaves runs/bench.json."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from benchmarks.environments import (
    CASES,
    MANY,
    QUICK_HZ,
    RUN_HZ,
    bullet_rate,
    reset_growth,
    step_rate,
    step_rates,
    vector_rate,
    way_off_mm,
)
from benchmarks.memory import long_run
from benchmarks.speed.closed_loop import loop_speed, peak_memory_mb, run_speed
from benchmarks.speed.filter_step import step_time_ms
from benchmarks.speed.render import render_times
from benchmarks.speed.whole_tracker import whole_tracker
from peopleboy.sim.physics.physics import PHYSICS

COUNTS = (300, 1000)
SCENARIOS = ("single_follow", "crossing_pair")
MEMORY_FRAMES = 10_000
RESETS = 100
OUT = Path("runs/bench.json")


@dataclass(frozen=True, slots=True)
class BenchFigure:
    """One figure: what it is of, as a path, how it is written, and what it should be."""

    path: tuple[str, ...]
    value: float
    form: str
    goal: str = ""


def main() -> None:
    """Measure, print one table, and keep the figures."""
    found = []
    table = Table("what", "figure", "goal", title="CPU time, medians of one run", box=None)
    for figure in measure():
        found.append(figure)
        name = ", ".join(figure.path).removesuffix(", ms")
        table.add_row(name, figure.form.format(figure.value), figure.goal)
    Console(width=120).print(table)
    OUT.parent.mkdir(parents=True, exist_ok=True)
    OUT.write_text(json.dumps(nested(found), indent=2) + "\n", encoding="utf-8")


def nested(figures: Sequence[BenchFigure]) -> dict[str, Any]:
    """Put the figures into mappings within mappings, as their paths say."""
    whole: dict[str, Any] = {}
    for figure in figures:
        inner = whole
        for step in figure.path[:-1]:
            inner = inner.setdefault(step, {})
        inner[figure.path[-1]] = figure.value
    return whole


def measure() -> Iterator[BenchFigure]:
    """Measure one after the other."""
    yield from _rendering()
    for count in COUNTS:
        goal = "at most 0.5 ms" if count == 1000 else ""
        yield BenchFigure(("filter step", f"N = {count}", "ms"), step_time_ms(count), "{:.3f} ms", goal)
    for name in SCENARIOS:
        yield BenchFigure(("closed loop", name), loop_speed(name), "{:.1f} x real time", "at least 5")
        yield BenchFigure(("peopleboy run", name), run_speed(name), "{:.1f} x real time")
    yield BenchFigure(("memory", "peak"), peak_memory_mb(), "{:.0f} MB")
    yield from _tracker()
    growth = long_run(MEMORY_FRAMES).bytes_per_frame
    yield BenchFigure(("memory", f"over {MEMORY_FRAMES} frames"), growth, "{:.0f} bytes a frame", "none")
    yield from _environments()


def _rendering() -> Iterator[BenchFigure]:
    drawn = render_times()
    yield BenchFigure(("rendering", "ray caster", "ms"), drawn.raycast_ms, "{:.2f} ms, 4 people, two views")
    yield BenchFigure(("rendering", "TinyRenderer", "ms"), drawn.bullet_ms, "{:.1f} ms, the same")
    yield BenchFigure(("rendering", "TinyRenderer", "ratio"), drawn.ratio, "{:.1f}", "at least 10")
    yield BenchFigure(("rendering", "full detail", "ms"), drawn.full_ms, "{:.2f} ms, by the ray caster")
    yield BenchFigure(("rendering", "full detail", "ratio"), drawn.full_ratio, "{:.2f}", "at most 1.5")


def _tracker() -> Iterator[BenchFigure]:
    found, of = whole_tracker(), "whole tracker"
    for crowd in found.crowds:
        form = f"{{:.2f}} ms, N = 1000 each, {crowd.tracked:.1f} tracked"
        goal = "at most 5 ms" if crowd is found.crowds[-1] else ""
        yield BenchFigure((of, f"{crowd.people} people", "ms"), crowd.frame_ms, form, goal)
    yield BenchFigure((of, "each further person", "ms"), found.person_ms, "{:.2f} ms")
    yield BenchFigure((of, "both images prepared", "ms"), found.prepare_ms, "{:.2f} ms, for all")
    for part, time_ms in found.parts_ms.items():
        yield BenchFigure((of, part, "ms"), time_ms, "{:.3f} ms, a person's 1000 samples")
    yield BenchFigure((of, "OpenCV's HOG", "ms"), found.hog_ms, "{:.0f} ms, frames of 4 people")
    yield BenchFigure((of, "OpenCV's HOG", "ratio"), found.hog_ratio, "{:.1f}", "at least 10")


def _environments() -> Iterator[BenchFigure]:
    of = "environments"
    for case, rate in product(CASES, (RUN_HZ, QUICK_HZ)):
        name, goal, form = f"{case.name}, physics at {rate} Hz", f"at least {case.goal}", "{:.0f} steps/s"
        yield BenchFigure((of, name, "one process"), step_rate(case, rate), form, goal)
        yield BenchFigure((of, name, "two processes"), step_rates(case, 2, rate), form)
    for case, physics in product(CASES, PHYSICS):
        name = f"{case.name}, {MANY} worlds, {physics} at {QUICK_HZ} Hz"
        yield BenchFigure((of, name, "one process"), vector_rate(case, physics), "{:.0f} steps/s")
    yield BenchFigure((of, f"way off at {QUICK_HZ} Hz"), way_off_mm(), "{:.1f} mm at most, 30 s")
    for size in ((320, 240), (80, 60)):
        name = f"getCameraImage, {size[0]} x {size[1]}"
        form = "{:.0f} steps/s, PyBullet's own images twice a step"
        yield BenchFigure((of, name, "one process"), bullet_rate(size), form)
    yield BenchFigure(("memory", f"over {RESETS} resets"), reset_growth(RESETS), "{:.0f} bytes each", "none")


if __name__ == "__main__":
    main()
