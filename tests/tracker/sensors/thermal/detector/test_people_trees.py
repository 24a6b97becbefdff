import itertools
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from peopleboy.tracker.sensors.thermal.detector.box_regression import OFFSETS
from peopleboy.tracker.sensors.thermal.detector.people_trees import (
    PeopleModel,
    PeopleTrees,
    shipped_people_trees,
)
from peopleboy.tracker.sensors.thermal.detector.vector_trees import LEAVES, NODES
from peopleboy.tracker.sensors.thermal.detector.window import WindowKind
from tests.helpers.calls.refused import refused
from tests.helpers.images.drawn_trees import PATCHES, PLACING_TREES, TREES, drawn_cascade, drawn_placing
from tests.helpers.import_graph import ROOT

DOCS = ROOT / "docs"
PLACING = (OFFSETS, PLACING_TREES)


def drawn_model() -> PeopleModel:
    one, other = drawn_cascade(), replace(drawn_cascade(), least=np.full(TREES, -1.0, np.float32))
    return PeopleModel(
        {
            WindowKind.WHOLE: PeopleTrees(one, drawn_placing()),
            WindowKind.CUT: PeopleTrees(replace(other, patches=one.patches), drawn_placing()),
        },
        {"whole people": "nothing"},
    )


def test_trees_come_back_from_their_file(tmp_path: Path) -> None:
    model = drawn_model()
    model.save(tmp_path / "people.npz")
    read = PeopleModel.load(tmp_path / "people.npz")
    assert read.about == model.about
    for kind, part in itertools.product(WindowKind, ("cascade", "regression")):
        before, after = getattr(model.trees[kind], part), getattr(read.trees[kind], part)
        np.testing.assert_array_equal(after.patches.channel, before.patches.channel, strict=True)
        np.testing.assert_array_equal(after.patches.first, before.patches.first, strict=True)
        np.testing.assert_array_equal(after.patches.second, before.patches.second, strict=True)
        for name in set(before.__dataclass_fields__) - {"patches"}:
            np.testing.assert_array_equal(getattr(after, name), getattr(before, name), strict=True)


def test_a_missing_file_names_the_command(tmp_path: Path) -> None:
    with refused("none.npz", "peopleboy train cascade"):
        PeopleModel.load(tmp_path / "none.npz")


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 broken", b"trees: [1, 2]"])
def test_what_is_no_archive_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "bad.npz").write_bytes(content)
    with refused("bad.npz", "not a file of weights"):
        PeopleModel.load(tmp_path / "bad.npz")


@pytest.mark.parametrize("share", [0.1, 0.5, 0.99])
def test_a_file_that_is_cut_off_is_refused(tmp_path: Path, share: float) -> None:
    path = tmp_path / "cut.npz"
    drawn_model().save(path)
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    with refused("cut.npz", "not a file of weights"):
        PeopleModel.load(path)


@pytest.mark.parametrize(
    "lack", ["whole_feature", "cut_least", "cut_placing_feature", "whole_placing_leaf", "about"]
)
def test_a_file_that_lacks_something_is_refused(tmp_path: Path, lack: str) -> None:
    drawn_model().save(tmp_path / "whole.npz")
    with np.load(tmp_path / "whole.npz") as archive:
        np.savez(tmp_path / "less.npz", **{name: archive[name] for name in archive if name != lack})
    with refused("less.npz", f"has no {lack}" if lack != "about" else "not a file of weights"):
        PeopleModel.load(tmp_path / "less.npz")


@pytest.mark.parametrize(
    ("part", "name", "wrong"),
    [
        ("cascade", "feature", np.full((TREES, NODES), PATCHES)),
        ("cascade", "feature", np.full((TREES, NODES), -1)),
        ("cascade", "feature", np.zeros((TREES, NODES + 1))),
        ("cascade", "leaf", np.full((TREES, LEAVES), np.nan, np.float32)),
        ("cascade", "leaf", np.zeros((TREES, LEAVES))),
        ("cascade", "threshold", np.full((TREES, NODES), np.nan, np.float32)),
        ("cascade", "least", np.zeros(TREES + 1, np.float32)),
        ("cascade", "least", np.zeros((), np.float32)),
        ("regression", "feature", np.full((*PLACING, NODES), PATCHES)),
        ("regression", "feature", np.zeros((PLACING_TREES, NODES))),
        ("regression", "leaf", np.full((*PLACING, LEAVES), np.inf, np.float32)),
        ("regression", "leaf", np.zeros((OFFSETS + 1, PLACING_TREES, LEAVES), np.float32)),
        ("regression", "threshold", np.zeros((*PLACING, NODES))),
    ],
)
@pytest.mark.parametrize("kind", WindowKind)
def test_other_trees_are_refused(tmp_path: Path, part: str, name: str, wrong: Any, kind: WindowKind) -> None:
    model = drawn_model()
    trees = model.trees[kind]
    other = trees._replace(**{part: replace(getattr(trees, part), **{name: wrong})})
    replace(model, trees={**model.trees, kind: other}).save(tmp_path / "other.npz")
    with refused("other.npz", "peopleboy train cascade"):
        PeopleModel.load(tmp_path / "other.npz")


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("channel", np.full(PATCHES, 9, np.uint8)),
        ("channel", np.zeros(PATCHES, np.int64)),
        ("first", np.tile(np.array([0, 0, 21, 1], np.uint8), (PATCHES, 1))),
        ("second", np.tile(np.array([0, 5, 1, 4], np.uint8), (PATCHES, 1))),
        ("second", np.zeros((PATCHES, 3), np.uint8)),
    ],
)
def test_patches_beyond_the_window_are_refused(tmp_path: Path, name: str, wrong: Any) -> None:
    model = drawn_model()
    trees = model.trees[WindowKind.WHOLE]
    patches = replace(trees.cascade.patches, **{name: wrong})
    other = trees._replace(cascade=replace(trees.cascade, patches=patches))
    replace(model, trees={**model.trees, WindowKind.WHOLE: other}).save(tmp_path / "other.npz")
    with refused("other.npz", "peopleboy train cascade"):
        PeopleModel.load(tmp_path / "other.npz")


def test_the_trees_that_are_shipped_say_what_they_were_trained_on() -> None:
    for kind in WindowKind:
        assert "from seed 1000" in shipped_people_trees().about[f"{kind} people"]


def test_the_pages_say_of_the_shipped_trees_what_their_file_does() -> None:
    results, data = (
        (DOCS / name).read_text(encoding="utf-8")
        for name in ("explanation/detector.md", "reference/models.md")
    )
    about = shipped_people_trees().about
    for mount in ("known", "unknown"):
        measured = about[f"on worlds 0 to 29, mount {mount}"]
        numbers = re.findall(r"(?:precision|recall|IoU) ([\d.]+)", measured)
        assert f"| mount {mount} | {' | '.join(numbers)} |" in results
    for name, kind in (("cascade", "whole"), ("second cascade", "cut")):
        worlds = sum(map(int, re.findall(r"(\d+) [^,;]+ from seed", about[f"{kind} people"])))
        (held,) = re.findall(r"(\d+) of them held out", about[f"{kind} people"])
        assert re.search(rf"\| {name} \| `--seeds {worlds}[^|]*` \| {held} sequences \|", data)
