from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from docs.generate.sources.source_pages import PAGE
from docs.generate.sources.source_run import FOLDER, RUN, SourceRun


def test_what_is_shipped_of_a_run_is_small_and_each_picture_belongs_to_a_part() -> None:
    sizes = {path.name: path.stat().st_size for path in FOLDER.iterdir()}
    assert sum(sizes.values()) < 3_500_000
    drawn = {one.picture for one in SourceRun.read().outcomes if one.picture is not None}
    assert set(sizes) == {*drawn, PAGE, RUN, "index.md"}


def test_a_run_is_kept_as_it_was_read(tmp_path: Path) -> None:
    SourceRun.read().write(tmp_path)
    assert (tmp_path / RUN).read_bytes() == (FOLDER / RUN).read_bytes()


def test_the_page_says_when_by_which_versions_and_what_is_missing() -> None:
    head = SourceRun.read().head
    assert {"Recorded", "Versions", "Seeds", "Machine", "Code"} <= head.facts.keys()
    page = (FOLDER / PAGE).read_text(encoding="utf-8")
    assert all(f"<dt>{name}</dt><dd>{fact}</dd>" in page for name, fact in head.lines)


def test_parts_of_a_later_run_take_their_places_and_are_said_to_be_later() -> None:
    shipped = SourceRun.read()
    number = "figure-5.4"
    part = next(one for one in shipped.outcomes if one.experiment.id == number)
    facts = {"Recorded": "2030-01-02", "Machine": "a toaster", "Code": "abc"}
    later = SourceRun(replace(shipped.head, facts=facts), (replace(part, left_out=("both",)),))
    joined = shipped.without([part]).with_later(later)
    ids = [[one.experiment.id for one in run.outcomes] for run in (shipped, joined)]
    assert ids[0] == ids[1]
    assert [one.left_out for one in joined.outcomes if one.experiment.id == number] == [("both",)]
    assert joined.head.facts[number] == "from a later run: recorded 2030-01-02; machine a toaster; code abc"
    assert number not in joined.without([part]).head.facts
    assert {**shipped.head.facts, number: joined.head.facts[number]} == joined.head.facts
    assert ("Parts", f"{joined.head.facts[number]} ({number})") in joined.head.lines


def test_what_a_run_took_as_a_whole_is_not_said_once_parts_of_another_are_there() -> None:
    shipped = SourceRun.read()
    part = shipped.outcomes[:1]
    first = SourceRun(replace(shipped.head, facts={**shipped.head.facts, "Time": "an hour"}), part)
    assert "Time" in first.head.facts
    assert "Time" not in first.with_later(shipped).head.facts
