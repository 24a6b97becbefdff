from __future__ import annotations

from pathlib import Path

from docs.generate.sources.source_pages import PAGE
from docs.generate.sources.source_run import FOLDER, RUN, SourceRun


def test_what_is_shipped_of_a_run_is_small_and_each_picture_belongs_to_a_part() -> None:
    sizes = {path.name: path.stat().st_size for path in FOLDER.iterdir()}
    assert sum(sizes.values()) < 3_000_000
    drawn = {one.picture for one in SourceRun.read().outcomes if one.picture is not None}
    assert set(sizes) == {*drawn, PAGE, RUN, "index.md"}


def test_a_run_is_kept_as_it_was_read(tmp_path: Path) -> None:
    SourceRun.read().write(tmp_path)
    assert (tmp_path / RUN).read_bytes() == (FOLDER / RUN).read_bytes()


def test_the_page_says_when_by_which_versions_and_what_is_missing() -> None:
    facts = SourceRun.read().head.facts
    assert {"Recorded", "Versions", "Seeds", "Machine", "Code"} <= facts.keys()
    page = (FOLDER / PAGE).read_text(encoding="utf-8")
    assert all(f"<dt>{name}</dt><dd>" in page for name in facts)
