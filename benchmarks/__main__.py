"""`make bench`: every figure of speed in the README, from one run."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from benchmarks.closed_loop import loop_speed, peak_memory_mb, run_speed
from benchmarks.environments import CASES, bullet_rate, reset_growth, step_rate, step_rates
from benchmarks.filter_step import step_time_ms
from benchmarks.memory import long_run
from benchmarks.render import render_times
from benchmarks.whole_tracker import whole_tracker

COUNTS = (300, 1000)
SCENARIOS = ("single_follow", "crossing_pair")
MEMORY_FRAMES = 10_000
RESETS = 100


def main() -> None:
    """Measure, and print one table."""
    table = Table("what", "figure", "goal", title="CPU time, medians of one run", box=None)
    drawn = render_times()
    table.add_row("ray caster, both views with full truth, 4 people", f"{drawn.raycast_ms:.2f} ms", "")
    table.add_row("TinyRenderer, the same", f"{drawn.bullet_ms:.1f} ms", "")
    table.add_row("ratio", f"{drawn.ratio:.1f}", "at least 10")
    for count in COUNTS:
        goal = "at most 0.5 ms" if count == 1000 else ""
        table.add_row(f"one filter step, N = {count}", f"{step_time_ms(count):.3f} ms", goal)
    for name in SCENARIOS:
        table.add_row(f"closed loop, {name}", f"{loop_speed(name):.1f} x real time", "at least 5")
        table.add_row(f"peopleboy run {name}, all it writes", f"{run_speed(name):.1f} x real time", "")
    table.add_row("peak memory", f"{peak_memory_mb():.0f} MB", "")
    _add_tracker(table)
    growth = long_run(MEMORY_FRAMES).bytes_per_frame
    table.add_row(f"growth of memory over {MEMORY_FRAMES} frames", f"{growth:.0f} bytes a frame", "none")
    _add_environments(table)
    Console(width=100).print(table)


def _add_environments(table: Table) -> None:
    for case in CASES:
        goal = f"at least {case.goal}"
        table.add_row(f"environment, {case.name}", f"{step_rate(case):.0f} steps/s", goal)
        table.add_row(f"environment, {case.name}, 2 processes", f"{step_rates(case, 2):.0f} steps/s", "")
    for size in ((320, 240), (80, 60)):
        name = f"PyBullet's getCameraImage twice a step, {size[0]} x {size[1]}"
        table.add_row(name, f"{bullet_rate(size):.0f} steps/s", "")
    table.add_row(f"growth of memory over {RESETS} resets", f"{reset_growth(RESETS):.0f} bytes each", "none")


def _add_tracker(table: Table) -> None:
    found = whole_tracker()
    for crowd in found.crowds:
        seen = f"{crowd.tracked:.1f} of {crowd.people} tracked"
        goal = "at most 5 ms" if crowd is found.crowds[-1] else ""
        table.add_row(f"whole tracker, N = 1000 each, {seen}", f"{crowd.frame_ms:.2f} ms", goal)
    table.add_row("each further person", f"{found.person_ms:.2f} ms", "")
    table.add_row("both images prepared for all", f"{found.prepare_ms:.2f} ms", "")
    for part, time_ms in found.parts_ms.items():
        table.add_row(f"a person's 1000 samples: {part}", f"{time_ms:.3f} ms", "")
    table.add_row("OpenCV's HOG on frames of 4 people", f"{found.hog_ms:.0f} ms", "")
    table.add_row("ratio", f"{found.hog_ratio:.1f}", "at least 10")


if __name__ == "__main__":
    main()
