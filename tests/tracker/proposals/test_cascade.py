from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.proposals.cascade import FEATURES, LEAVES, NODES, Cascade
from peopleboy.tracker.proposals.channels import CHANNELS
from peopleboy.tracker.proposals.window import COLUMNS, ROWS

TREES = 40
Cells = NDArray[np.float32]


def drawn_cascade(least: float = -np.inf) -> Cascade:
    rng = np.random.default_rng(4)
    return Cascade(
        feature=rng.integers(0, FEATURES, (TREES, NODES)).astype(np.int32),
        threshold=rng.normal(size=(TREES, NODES)).astype(np.float32),
        leaf=rng.normal(size=(TREES, LEAVES)).astype(np.float32),
        least=np.full(TREES, least, np.float32),
        about={"trained on": "nothing"},
    )


def drawn_cells() -> Cells:
    return np.random.default_rng(5).normal(size=(CHANNELS, 34, 27)).astype(np.float32)


def score_of(window: Cells, cascade: Cascade) -> list[float]:
    """Walk down the trees one after another; give what they add up to after each."""
    scores, score = [], 0.0
    for feature, threshold, leaf in zip(cascade.feature, cascade.threshold, cascade.leaf, strict=True):
        node = 0
        while node < NODES:
            node = 2 * node + (2 if window.ravel()[feature[node]] > threshold[node] else 1)
        score += float(leaf[node - NODES])
        scores.append(score)
    return scores


def test_all_windows_have_the_score_that_their_trees_add_up_to() -> None:
    cells, cascade = drawn_cells(), drawn_cascade()
    hits = cascade.scan(cells, (0, 34), stride=1)
    assert len(hits.score) == (34 - ROWS + 1) * (27 - COLUMNS + 1)
    for row, column, score in zip(*hits, strict=True):
        window = cells[:, row : row + ROWS, column : column + COLUMNS]
        assert score == pytest.approx(score_of(window, cascade)[-1], abs=1e-4)


def test_a_window_that_is_not_let_go_has_the_score_that_it_has_without_letting_go() -> None:
    cells = drawn_cells()
    all_of_them = drawn_cascade().scan(cells, (0, 34), stride=1)
    some = drawn_cascade(least=-1.0).scan(cells, (0, 34), stride=1)
    scores = dict(zip(zip(all_of_them.row, all_of_them.column, strict=True), all_of_them.score, strict=True))
    assert 0 < len(some.score) < len(all_of_them.score)
    for row, column, score in zip(*some, strict=True):
        running = score_of(cells[:, row : row + ROWS, column : column + COLUMNS], drawn_cascade())
        assert score == scores[row, column]
        assert min(running) > -1.0 - 1e-4


def test_a_stride_misses_some_windows_and_makes_up_none() -> None:
    cells, cascade = drawn_cells(), drawn_cascade(least=-1.0)
    every, coarse = (set(zip(*cascade.scan(cells, (0, 34), stride=stride), strict=True)) for stride in (1, 2))
    assert coarse <= every


def test_beside_a_window_that_comes_through_all_are_looked_at() -> None:
    cells, cascade = drawn_cells(), drawn_cascade()
    assert set(zip(*cascade.scan(cells, (0, 34)), strict=True)) == set(
        zip(*cascade.scan(cells, (0, 34), stride=1), strict=True)
    )


def test_only_the_rows_that_are_asked_for_are_looked_at() -> None:
    assert set(drawn_cascade().scan(drawn_cells(), (3, 6)).row.tolist()) == {3, 4, 5}


@pytest.mark.parametrize("rows", [(5, 5), (20, 34), (-9, 0)])
def test_where_no_window_fits_none_is_found(rows: tuple[int, int]) -> None:
    assert len(drawn_cascade().scan(drawn_cells(), rows).score) == 0


def test_running_scores_are_those_of_the_trees() -> None:
    windows = np.random.default_rng(6).normal(size=(5, FEATURES)).astype(np.float32)
    expected = [score_of(window, drawn_cascade()) for window in windows]
    np.testing.assert_allclose(drawn_cascade().running(windows), expected, atol=1e-4)


def test_trees_come_back_from_their_file(tmp_path: Path) -> None:
    cascade = drawn_cascade()
    cascade.save(tmp_path / "people.npz")
    read = Cascade.load(tmp_path / "people.npz")
    assert read.about == cascade.about
    for name in ("feature", "threshold", "leaf", "least"):
        np.testing.assert_array_equal(getattr(read, name), getattr(cascade, name))


def test_a_missing_file_names_the_command(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="train-detector"):
        Cascade.load(tmp_path / "none.npz")


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 broken", b"trees: [1, 2]"])
def test_what_is_no_archive_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "bad.npz").write_bytes(content)
    with pytest.raises(BadInput, match="is no file of weights"):
        Cascade.load(tmp_path / "bad.npz")


@pytest.mark.parametrize("share", [0.1, 0.5, 0.99])
def test_a_file_that_is_cut_off_is_refused(tmp_path: Path, share: float) -> None:
    path = tmp_path / "cut.npz"
    drawn_cascade().save(path)
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    with pytest.raises(BadInput, match="is no file of weights"):
        Cascade.load(path)


@pytest.mark.parametrize(
    "wrong",
    [
        {"feature": np.full((TREES, NODES), FEATURES)},
        {"feature": np.full((TREES, NODES), -1)},
        {"feature": np.zeros((TREES, NODES + 1))},
        {"leaf": np.full((TREES, LEAVES), np.nan, np.float32)},
        {"leaf": np.zeros((TREES, LEAVES))},
        {"threshold": np.full((TREES, NODES), np.nan, np.float32)},
        {"least": np.zeros(TREES + 1, np.float32)},
        {"least": np.zeros((), np.float32)},
    ],
)
def test_other_trees_are_refused(tmp_path: Path, wrong: dict[str, NDArray[np.generic]]) -> None:
    replace(drawn_cascade(), **wrong).save(tmp_path / "other.npz")  # type: ignore[arg-type]
    with pytest.raises(BadInput, match=r"other\.npz: holds no trees of depth 3 on the 1800 features"):
        Cascade.load(tmp_path / "other.npz")


def test_the_trees_that_are_shipped_say_what_they_were_trained_on() -> None:
    assert "seeds from 1000" in shipped_model().about["trained on"]
