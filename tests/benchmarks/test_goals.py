import io
import json
from pathlib import Path

import pytest
from rich.console import Console

from benchmarks.goals import BenchFigure, Goal, earlier, nested, read_figures, reasons, table_of
from peopleboy.bad_input import BadInput

QUICK = BenchFigure(("tracker", "HOG", "ratio"), 20.0, "{:.1f}", Goal(least=30), "its parts")
SMALL = BenchFigure(("memory", "peak"), 400.0, "{:.0f} MB", Goal(most=500, unit=" MB"))
PLAIN = BenchFigure(("tracker", "step", "ms"), 0.4, "{:.1f} ms")


def test_figures_are_kept_by_their_paths_and_found_again() -> None:
    kept = nested([QUICK, PLAIN])
    assert kept == {"tracker": {"HOG": {"ratio": 20.0}, "step": {"ms": 0.4}}}
    assert earlier(PLAIN, kept) == 0.4
    assert earlier(SMALL, kept) is None
    assert earlier(BenchFigure(("tracker", "step", "ms", "more"), 1.0, ""), kept) is None


def test_what_misses_its_goal_comes_first_and_says_why() -> None:
    console = Console(width=150, record=True, file=io.StringIO())
    console.print(table_of([PLAIN, SMALL, QUICK], {"tracker": {"HOG": {"ratio": 10.0}}}))
    rows = console.export_text().splitlines()[2:]
    assert [row.split("  ")[0].strip() for row in rows] == [
        "tracker, HOG, ratio",
        "tracker, step",
        "memory, peak",
    ]
    assert rows[0].split()[-2:] == ["10", "2.00"]
    assert reasons([PLAIN, SMALL, QUICK]) == ["tracker, HOG, ratio misses its goal: its parts"]


def test_an_earlier_run_must_be_one(tmp_path: Path) -> None:
    for text in ("nothing", json.dumps([1])):
        (tmp_path / "old.json").write_text(text)
        with pytest.raises(BadInput, match=r"runs/bench\.json"):
            read_figures(tmp_path / "old.json")
    with pytest.raises(BadInput, match=r"missing\.json"):
        read_figures(tmp_path / "missing.json")
