"""`make bench`: every figure of speed in the README, from one run."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from benchmarks.closed_loop import loop_speed, peak_memory_mb, run_speed
from benchmarks.filter_step import step_time_ms
from benchmarks.render import render_times

COUNTS = (300, 1000)
SCENARIOS = ("single_follow", "crossing_pair")


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
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
