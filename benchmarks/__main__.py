"""`make bench`: measure the speed of all parts in one run, and write runs/bench.json."""

import json
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import click
from rich.console import Console

from benchmarks import call
from benchmarks.goals import BenchFigure, Goal, nested, read_figures, reasons, table_of
from benchmarks.speed.closed_loop import loop_speed, peak_memory_mb, run_speed
from benchmarks.speed.contour_tracker import (
    FILTER_STEP,
    HOG,
    ContourTimes,
    beside_hog,
    contour_times,
    films,
    step_time_ms,
)
from benchmarks.speed.drone import CASES as BESIDE_DRONE
from benchmarks.speed.drone import drone_rates
from benchmarks.speed.environments import (
    CASES,
    MANY,
    PIXELS,
    QUICK_HZ,
    RUN_HZ,
    THREADS,
    TRUTH,
    bullet_rate,
    many_rates,
    step_rate,
    step_rates,
    vector_rate,
    way_off_mm,
)
from benchmarks.speed.full_detail import BULLET, FULL, RAYCAST, render_times
from benchmarks.speed.memory import long_run, reset_growth
from peopleboy.sim.physics.physics_engine import PHYSICS
from peopleboy.tracker.trackers import CONTOUR_TRACKER, DEFAULT_TRACKER

COUNTS = (300, 1000)
SCENARIOS = ("single_follow", "crossing_pair")
MEMORY_FRAMES = 10_000
RESETS = 100
OUT = Path("runs/bench.json")
_MANY_PIXELS = "two thirds are rendering; the single world became a third faster since the goal was set"
FLAT = Goal(most=1000)  # bytes each: less than one image of the smallest camera


@click.command()
@click.option("--compare", type=click.Path(path_type=Path), help="Results of an earlier run to compare with.")
def main(compare: Path | None) -> None:
    """Measure, print missed goals first and then the rest, and write the results."""
    before = None if compare is None else read_figures(compare)
    found = list(measure())
    console = Console(width=150 if before is not None else 120)
    console.print(table_of(found, before))
    for line in reasons(found):
        console.print(line, highlight=False)
    OUT.parent.mkdir(parents=True, exist_ok=True)
    OUT.write_text(json.dumps(nested(found), indent=2) + "\n", encoding="utf-8")


def measure() -> Iterator[BenchFigure]:
    """Run all measurements one after another."""
    yield from _rendering()
    for count in COUNTS:
        goal = Goal(most=0.5, unit=" ms") if count == 1000 else None
        yield BenchFigure(("filter step", f"N = {count}", "ms"), step_time_ms(count), "{:.3f} ms", goal)
    for name in SCENARIOS:
        yield BenchFigure(("closed loop", name), loop_speed(name), "{:.1f} x real time", Goal(least=5))
        yield BenchFigure(("peopleboy run", name), run_speed(name), "{:.1f} x real time")
    yield BenchFigure(("memory", "peak"), peak_memory_mb(), "{:.0f} MB")
    yield from _tracker()
    growth = long_run(MEMORY_FRAMES).bytes_per_frame
    yield BenchFigure(("memory", f"over {MEMORY_FRAMES} frames"), growth, "{:.0f} bytes a frame", FLAT)
    yield from _environments()
    yield from _drone()


def _rendering() -> Iterator[BenchFigure]:
    of, drawn = "rendering", render_times()
    cast_ms, bullet_ms, full_ms = map(drawn.median, (RAYCAST, BULLET, FULL))
    yield BenchFigure((of, "ray caster", "ms"), cast_ms, "{:.2f} ms, 4 people, two views")
    yield BenchFigure((of, "TinyRenderer", "ms"), bullet_ms, "{:.1f} ms, the same")
    yield BenchFigure((of, "TinyRenderer", "ratio"), drawn.ratio(BULLET, RAYCAST), "{:.1f}", Goal(least=10))
    yield BenchFigure((of, "full detail", "ms"), full_ms, "{:.2f} ms, by the ray caster")
    yield BenchFigure((of, "full detail", "ratio"), drawn.ratio(FULL, RAYCAST), "{:.2f}", Goal(most=1.5))


def _tracker() -> Iterator[BenchFigure]:
    crowds, of = films(), "contour tracker"
    found = contour_times(crowds)
    reason = _where_time_goes(found)
    for crowd in found.crowds:
        form = f"{{:.2f}} ms, N = 1000 each, {crowd.tracked:.1f} tracked"
        goal = Goal(most=5, unit=" ms") if crowd is found.crowds[-1] else None
        yield BenchFigure((of, f"{crowd.people} people", "ms"), crowd.frame_ms, form, goal, reason)
    yield BenchFigure((of, "each further person", "ms"), found.person_ms, "{:.2f} ms")
    yield BenchFigure((of, "both images prepared", "ms"), found.prepare_ms, "{:.2f} ms, for all")
    for part, time_ms in found.parts_ms.items():
        yield BenchFigure((of, part, "ms"), time_ms, "{:.3f} ms, a person's 1000 samples")
    hog, by = beside_hog(crowds[-1]), "OpenCV's HOG"
    yield BenchFigure((of, by, "ms"), hog.median(HOG), "{:.0f} ms, frames of 4 people")
    yield BenchFigure((of, by, "ratio"), hog.ratio(HOG, CONTOUR_TRACKER), "{:.1f}", Goal(least=20), reason)
    other, where = (
        "default tracker, 4 people",
        "two fifths are trees that search every third to sixth image, a third are networks on detections",
    )
    yield BenchFigure((other, "ms"), hog.median(DEFAULT_TRACKER), "{:.1f} ms, mean of some frames")
    yield BenchFigure((other, by, "ratio"), hog.ratio(HOG, DEFAULT_TRACKER), "{:.1f}", Goal(least=9.8), where)
    yield BenchFigure(
        (FILTER_STEP, by, "ratio"), hog.ratio(HOG, FILTER_STEP), "{:.0f}", Goal(least=400), reason
    )


def _where_time_goes(found: ContourTimes) -> str:
    """Return how the time of an additional person is divided, in descending order."""
    parts = sorted(found.parts_ms.items(), key=lambda part: -part[1])
    rest = found.person_ms - sum(found.parts_ms.values())
    shares = [f"{name} {time_ms:.2f}" for name, time_ms in [*parts, ("remaining code", rest)]]
    return f"each additional person takes {found.person_ms:.2f} ms: {', '.join(shares)}"


def _environments() -> Iterator[BenchFigure]:
    of = "environments"
    for case, rate in product(CASES, (RUN_HZ, QUICK_HZ)):
        name, goal, form = f"{case.name}, physics at {rate} Hz", Goal(least=case.goal), "{:.0f} steps/s"
        yield BenchFigure((of, name, "one process"), step_rate(case, rate), form, goal)
        yield BenchFigure((of, name, "two processes"), step_rates(case, 2, rate), form)
    for case, physics in product(CASES, PHYSICS):
        name = f"{case.name}, {MANY} worlds, {physics} at {QUICK_HZ} Hz"
        yield BenchFigure((of, name, "one process"), vector_rate(case, physics), "{:.0f} steps/s")
    for case, worlds, threads, least, reason in (
        (TRUTH, 64, 1, 20, "sonar, contacts and random numbers take half of a step"),
        (PIXELS, MANY, THREADS, 10, _MANY_PIXELS),
    ):
        ratio = many_rates(case, (worlds,), threads)[worlds].ratio
        name = f"{case.name}, {worlds} worlds, kinematic, {threads} {'threads' if threads > 1 else 'thread'}"
        yield BenchFigure(
            (of, name, "one PyBullet world", "ratio"), ratio, "{:.1f}", Goal(least=least), reason
        )
    yield BenchFigure((of, f"way off at {QUICK_HZ} Hz"), way_off_mm(), "{:.1f} mm at most, 30 s")
    for size in ((320, 240), (80, 60)):
        name = f"getCameraImage, {size[0]} x {size[1]}"
        form = "{:.0f} steps/s, PyBullet's own images twice a step"
        yield BenchFigure((of, name, "one process"), bullet_rate(size), form)
    yield BenchFigure(("memory", f"over {RESETS} resets"), reset_growth(RESETS), "{:.0f} bytes each", FLAT)


def _drone() -> Iterator[BenchFigure]:
    of, name, form = "environments", "a drone with vision, 64 x 48", "{:.0f} steps/s"
    found = drone_rates()
    reason = "16 steps of PyBullet's physics alone take longer than a tenth of the drone's whole step"
    yield BenchFigure((of, name, "every second image"), found.drone_s, form)
    yield BenchFigure((of, name, "every image"), found.drone_images_s, form)
    for case, rate in found.ours_s.items():
        physics, physics_hz, worlds = case
        many = "" if worlds == 1 else f", {worlds} worlds"
        ours = of, f"pixels, one camera, 64 x 48, {physics} at {physics_hz} Hz{many}"
        yield BenchFigure((*ours, "one process"), rate, form)
        goal = Goal(least=10) if case == BESIDE_DRONE[0] else None
        yield BenchFigure((*ours, "a drone with vision", "ratio"), found.ratios[case], "{:.2f}", goal, reason)


if __name__ == "__main__":
    call(main, "benchmarks")
