from pathlib import Path

import click
import pytest

from benchmarks.bytes import compare_checkouts, compare_folders


def write_run(folder: Path, **contents: bytes) -> Path:
    files = {"thermal/000001.png": b"a", "colour/000001.png": b"b", "truth/gt.txt": b"c", "tracks.txt": b"d"}
    for name, content in (files | contents).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return folder


def test_runs_of_the_same_bytes_agree_whatever_else_lies_beside_them(tmp_path: Path) -> None:
    ours, theirs = write_run(tmp_path / "a"), write_run(tmp_path / "b", **{"metrics.json": b"other"})
    assert compare_folders("x", ours, theirs).differing == ()


def test_a_byte_that_differs_and_a_file_that_is_missing_are_named(tmp_path: Path) -> None:
    ours = write_run(tmp_path / "a")
    theirs = write_run(tmp_path / "b", **{"tracks.txt": b"D", "thermal/000002.png": b"e"})
    assert compare_folders("x", ours, theirs).differing == ("thermal/000002.png", "tracks.txt")


def test_a_checkout_that_was_never_set_up_is_refused_with_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(click.ClickException, match=r"make \.venv/\.ready"):
        compare_checkouts(["single_follow"], tmp_path, tmp_path)
