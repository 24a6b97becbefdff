"""Tables and plots of metrics for papers, from scores that are made up."""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.scores.by_tracker import Groups, ScoredRun
from peopleboy.scenarios.scores.people_ranges import OCCLUSION_RANGES, VISIBLE_RANGES, PeopleRange
from peopleboy.scenarios.scores.tables.score_plots import draw_plots, identity_kept
from peopleboy.scenarios.scores.tables.score_table import ALL, Per, ScoreTable, make_table, score_parts
from peopleboy.scenarios.scores.tables.write_table import escape_latex, to_csv, to_latex, to_markdown
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.occlusion_scores import OccludedShares, Occlusion
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.evaluation.table import parse_figures
from tests.helpers.calls.refused import refused
from tests.helpers.images.random_sequences import tracks_of, truth_of

PERSON = (0, 0, 20, 60)
FIGURES = parse_figures("CR,IDSW")


def found(count: int) -> Scores:
    """One person who is found in so many of ten frames."""
    truth = truth_of([(frame, 1, *PERSON) for frame in range(1, 11)])
    return evaluate(truth, tracks_of([(frame, 1, *PERSON) for frame in range(1, count + 1)]))


def runs(tracker: str, **counts: int) -> list[ScoredRun]:
    scenes = {"a": "crossing_2", "b": "b & c"}
    return [
        ScoredRun(f"runs/{name}", tracker, (scenes[name[0]], int(name[1])), found(count))
        for name, count in counts.items()
    ]


GROUPS = {"ours": runs("ours", a0=5, a1=6, b0=7), "my.Tracker_x": runs("my.Tracker_x", a0=9, a1=8, b0=10)}


def table(per: Per | None = None, groups: Groups = GROUPS) -> ScoreTable:
    return make_table(score_parts(lambda _: groups, per), FIGURES, per)


def test_csv_has_every_digit_of_value_mean_interval_and_test() -> None:
    lines = list(csv.DictReader(io.StringIO(to_csv(table()))))
    assert len(lines) == 3 * len(FIGURES)
    ours, _, theirs, _, apart, switches = lines
    assert (ours["tracker"], ours["metric"], ours["unit"], ours["runs"]) == ("ours", "CR", "%", "3")
    assert float(ours["all_frames"]) == pytest.approx(60.0)
    assert float(ours["mean"]) == pytest.approx(60.0)
    assert float(ours["sd"]) == pytest.approx(np.std([50.0, 60.0, 70.0], ddof=1))
    assert 50.0 <= float(ours["ci_low"]) < 60.0 < float(ours["ci_high"]) <= 70.0
    assert ours["p"] == apart["all_frames"] == apart["sd"] == ""
    assert (theirs["tracker"], apart["compared_with"]) == ("my.Tracker_x", "ours")
    assert float(apart["mean"]) == pytest.approx((40.0 + 20.0 + 30.0) / 3)
    assert float(apart["p"]) == pytest.approx(0.25)
    assert float(switches["p"]) == 1.0


def test_markdown_has_a_row_per_tracker_and_difference_with_the_best_bold() -> None:
    lines = to_markdown(table()).splitlines()
    assert lines[0] == "| tracker | runs | CR [%] ↑ | IDSW ↓ |"
    assert lines[1] == "| --- | ---: | ---: | ---: |"
    assert re.match(r"\| ours \| 3 \| 60\.0 ± 10\.0 \[\d+\.\d, \d+\.\d\] \| 0\.0 ± 0\.0", lines[2])
    assert re.match(r"\| my\.Tracker_x \| 3 \| \*\*90\.0\*\* ± 10\.0 ", lines[3])
    assert re.match(r"\| my\.Tracker_x - ours \| 3 \| \+30\.0 \[.*\], p = 0\.250 \| ", lines[4])
    assert "bootstrap interval" in lines[-1]
    assert "Wilcoxon" in lines[-1]


def test_latex_is_balanced_escaped_and_has_as_many_cells_in_each_row() -> None:
    text = to_latex(table(Per.SCENARIO))
    assert text.count("{") == text.count("}")
    for environment in ("table", "tabular"):
        assert text.count(rf"\begin{{{environment}}}") == text.count(rf"\end{{{environment}}}") == 1
    rows = [line for line in text.splitlines() if line.endswith(r"\\")]
    cells = {len(re.findall(r"(?<!\\)&", row)) for row in rows}
    columns = re.search(r"\\begin\{tabular\}\{(\w+)\}", text)
    assert columns is not None
    assert cells == {len(columns[1]) - 1}
    assert r"crossing\_2 & my.Tracker\_x & 2" in text
    assert r"b \& c & ours & 1 & 70.0 & 0" in text
    assert escape_latex("50 % of #1_a") == r"50 \% of \#1\_a"


def test_parts_are_scenarios_sequences_or_runs_and_all_together() -> None:
    assert list(score_parts(lambda _: GROUPS, Per.SCENARIO)) == ["crossing_2", "b & c", ALL]
    assert list(score_parts(lambda _: GROUPS, Per.SEQUENCE)) == [
        "crossing_2-0",
        "crossing_2-1",
        "b & c-0",
        ALL,
    ]
    assert list(score_parts(lambda _: GROUPS, Per.RUN)) == ["runs/a0", "runs/a1", "runs/b0", ALL]
    assert list(score_parts(lambda _: GROUPS, None)) == [ALL]
    nameless = {"x": [ScoredRun("f.txt", "x", None, found(1))]}
    with refused("f.txt", "--per run"):
        score_parts(lambda _: nameless, Per.SCENARIO)


def test_trackers_with_different_numbers_of_runs_have_no_best() -> None:
    uneven = {"ours": GROUPS["ours"], "theirs": runs("theirs", a0=9)}
    assert "**" not in to_markdown(table(groups=uneven))


def hidden_for(frames: int, person: int = 1) -> tuple[TrueBoxes, np.ndarray]:
    """Give a person who is fully occluded for so many of 40 frames."""
    truth = truth_of([(frame, person, *PERSON) for frame in range(1, 41)])
    share = np.where((truth.frame > 10) & (truth.frame <= 10 + frames), 1.0, 0.0)
    return truth, share


@pytest.mark.parametrize(
    ("frames", "name"),
    [(0, "never hidden"), (3, "0 to 0.35 s"), (10, "0.35 to 0.75 s"), (20, "0.75 to 1.5 s")],
)
def test_a_person_is_in_the_range_of_the_longest_full_occlusion(frames: int, name: str) -> None:
    truth, share = hidden_for(frames)
    counted = {one.name: one.take(truth, lambda: OccludedShares(share, 15.0)) for one in OCCLUSION_RANGES}
    assert [known for known, part in counted.items() if part.counted.any()] == [name]
    assert counted[name].counted.all()


def test_ranges_of_visible_fraction_hold_each_visible_row_once() -> None:
    visible = np.linspace(0.0, 1.0, 21)
    boxes = np.tile(np.array(PERSON, float), (21, 1))
    truth = TrueBoxes(frame=np.arange(1, 22), id=np.ones(21), box=boxes, counted=np.ones(21), visible=visible)
    parts = [one.take(truth, lambda: OccludedShares(visible, 15.0)).counted for one in VISIBLE_RANGES]
    assert np.sum(parts, axis=0).tolist() == (visible > 0.0).astype(int).tolist()


def test_a_range_without_people_has_no_part() -> None:
    def score(people: PeopleRange | None) -> Groups:
        truth, share = hidden_for(10)
        if people is not None:
            truth = people.take(truth, lambda: OccludedShares(share, 15.0))
        return {"ours": [ScoredRun("run", "ours", ("a", 0), evaluate(truth, tracks_of([(1, 1, *PERSON)])))]}

    assert list(score_parts(score, Per.OCCLUSION_TIME)) == ["0.35 to 0.75 s", ALL]


def occlusion(duration_s: float, after: int) -> Occlusion:
    return Occlusion(
        person=1,
        start_frame=1,
        end_frame=9,
        duration_s=duration_s,
        id_before=1,
        id_after=after,
        found_after_s=0.1,
    )


def test_the_share_of_kept_identities_has_the_interval_of_wilson() -> None:
    at, (share,) = identity_kept([occlusion(1.0, 1)] * 3 + [occlusion(1.0, 2)])
    assert list(at) == [2]
    z, n, p = 1.959964, 4, 0.75
    middle, half = p + z**2 / (2 * n), z * np.sqrt(p * (1 - p) / n + z**2 / (4 * n**2))
    expected = [100.0 * (middle + sign * half) / (1 + z**2 / n) for sign in (-1, 1)]
    assert (share.mean, share.low, share.high) == pytest.approx((75.0, *expected), rel=1e-5)


def test_plots_are_svg_and_pdf_with_the_same_bytes_each_time(tmp_path: Path) -> None:
    kept = {"ours": [occlusion(0.5, 1), occlusion(2.0, 2)], "my.Tracker_x": [occlusion(0.5, 1)]}
    one, two = (draw_plots(tmp_path / name, kept, [GROUPS] * len(VISIBLE_RANGES)) for name in "ab")
    assert [path.name for path in one] == [
        *("identity_kept.svg", "identity_kept.pdf", "hota_by_visibility.svg", "hota_by_visibility.pdf")
    ]
    assert [path.read_bytes() for path in one] == [path.read_bytes() for path in two]
    assert one[0].read_text().startswith("<?xml")
    assert one[1].read_bytes().startswith(b"%PDF")
