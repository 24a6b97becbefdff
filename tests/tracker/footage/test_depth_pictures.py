from pathlib import Path

import numpy as np
import pytest

from peopleboy.tracker.footage.depth_pictures import DepthCounts, pair_up
from tests.helpers.calls.refused import refused


def paths(folder: str, *names: str) -> list[Path]:
    return [Path(folder) / f"{name}.png" for name in names]


def stems(found: list[Path]) -> list[str]:
    return [path.stem for path in found]


def test_names_that_are_no_times_go_together_by_their_order() -> None:
    pairs = pair_up(paths("rgb", "a1", "a2"), paths("depth", "d7", "d8"))
    assert (stems(pairs.colour), stems(pairs.depth)) == (["a1", "a2"], ["d7", "d8"])
    assert pairs.time_s is None
    assert pairs.rate_hz is None


@pytest.mark.parametrize(
    ("colour", "depth"),
    [
        (["a1", "a2", "a4"], ["d7", "d8", "d9"]),  # one is missing in one folder alone
        (["a1", "a3", "a4", "a6"], ["d11", "d12", "d14", "d15"]),
        (["anna", "ben"], ["c1", "c2"]),
        (["1.5", "1.62", "1.7"], ["1", "2", "3"]),
    ],
)
def test_names_that_do_not_say_what_belongs_together_are_refused(colour: list[str], depth: list[str]) -> None:
    with refused("depth", "rgb", "same numbers"):
        pair_up(paths("rgb", *colour), paths("depth", *depth))


@pytest.mark.parametrize(("digits", "unit_s"), [(13, 1e-3), (16, 1e-6), (19, 1e-9)])
def test_whole_numbers_since_1970_are_times(digits: int, unit_s: float) -> None:
    rng = np.random.default_rng(1)
    colour = 1700000000.0 + np.arange(44) / 15
    kept = np.sort(rng.choice(44, 40, replace=False))
    count = [f"cam_{round(time / unit_s):0{digits}d}" for time in colour]
    later = [f"{round((time + 0.009) / unit_s):0{digits}d}" for time in colour[kept]]
    pairs = pair_up(paths("rgb", *count), paths("depth", *later))
    assert stems(pairs.colour) == [count[k] for k in kept]
    assert stems(pairs.depth) == later
    assert pairs.rate_hz == pytest.approx(15, abs=0.3)


def test_a_list_of_pairs_beside_the_folders_decides(tmp_path: Path) -> None:
    colour = [tmp_path / "rgb" / f"{k}.png" for k in (1, 2, 3)]
    depth = [tmp_path / "depth" / f"{k}.png" for k in (1, 2, 3)]
    (tmp_path / "associations.txt").write_text(
        "0.1 rgb/1.png 0.2 depth/2.png\n0.3 depth/3.png 0.3 rgb/3.png\n"
    )
    pairs = pair_up(colour, depth)
    assert (stems(pairs.colour), stems(pairs.depth)) == (["1", "3"], ["2", "3"])
    assert "1 of 3" in pairs.note


def test_if_one_folder_alone_has_times_order_decides() -> None:
    pairs = pair_up(paths("rgb", "1.5", "1.6"), paths("depth", "1", "2"))
    assert (stems(pairs.depth), pairs.time_s) == (["1", "2"], None)


def test_more_of_one_kind_than_of_the_other_is_refused() -> None:
    with refused("depth", "rgb", "2", "got 1"):
        pair_up(paths("rgb", "1", "2"), paths("depth", "1"))


def test_times_go_together_by_the_nearest_whatever_their_order_and_number() -> None:
    rng = np.random.default_rng(3)
    colour = 1305031102.0 + np.arange(40) / 30
    depth = np.concatenate([colour + rng.uniform(-0.015, 0.015, 40), colour[-1] + [0.4, 0.9]])
    names = [[f"{time:.6f}" for time in times] for times in (colour, depth)]
    for shuffled in names:
        rng.shuffle(shuffled)
    pairs = pair_up(paths("rgb", *names[0]), paths("depth", *names[1]))
    assert stems(pairs.colour) == [f"{time:.6f}" for time in colour]
    read = np.array([float(name) for name in names[1]])
    for one, other in zip(stems(pairs.colour), stems(pairs.depth), strict=True):
        assert abs(float(one) - float(other)) == np.abs(read - float(one)).min()
    assert pairs.time_s == pytest.approx(np.arange(40) / 30, abs=2e-6)
    assert pairs.rate_hz == pytest.approx(30, abs=1e-3)


def test_decimals_are_those_of_a_number_not_a_count() -> None:
    pairs = pair_up(paths("rgb", "5.10", "5.9"), paths("depth", "5.9", "5.10"))
    assert stems(pairs.colour) == stems(pairs.depth) == ["5.10", "5.9"]
    assert pairs.time_s == pytest.approx([0.0, 0.8])


@pytest.mark.parametrize(("number", "away_s"), [(0, 0.06), (8, -0.06), (8, 0.06)])
def test_depth_that_is_off_by_more_than_half_a_pictures_time_is_left_out(number: int, away_s: float) -> None:
    colour = [f"{10 + k / 10:.3f}" for k in range(9)]
    depth = [f"{10 + k / 10 + away_s * (k == number):.3f}" for k in range(9)]
    pairs = pair_up(paths("rgb", *colour), paths("depth", *depth))
    kept = [k for k in range(9) if k != number]
    assert stems(pairs.colour) == [colour[k] for k in kept]
    assert stems(pairs.depth) == [depth[k] for k in kept]
    assert f"rgb/{colour[number]}.png" in pairs.note
    assert "1 of 9" in pairs.note
    assert pairs.time_s == pytest.approx([(k - kept[0]) / 10 for k in kept])
    near = [f"{10 + k / 10 + 0.05:.3f}" for k in range(9)]
    assert len(pair_up(paths("rgb", *colour), paths("depth", *near)).depth) == 9


def test_pairs_of_the_tum_benchmark_are_up_to_20_ms_apart() -> None:
    colour = [f"{10 + k / 30:.6f}" for k in range(9)]
    depth = [f"{10 + k / 30 + 0.019:.6f}" for k in range(9)]
    pairs = pair_up(paths("rgb", *colour), paths("depth", *depth))
    assert len(pairs.colour) == 9
    assert pairs.note == ""


def test_pictures_that_are_missing_in_one_folder_are_left_out_by_their_numbers() -> None:
    colour, depth = [f"a{k:03}" for k in (1, 2, 4, 5, 6)], [f"d{k}" for k in (1, 2, 3, 5, 6)]
    pairs = pair_up(paths("rgb", *colour), paths("depth", *depth))
    assert stems(pairs.colour) == ["a001", "a002", "a005", "a006"]
    assert stems(pairs.depth) == ["d1", "d2", "d5", "d6"]
    assert "a004.png" in pairs.note


def test_rows_that_begin_with_other_numbers_go_together_by_their_order() -> None:
    colour, depth = [f"a{k}" for k in range(5)], [f"d{k}" for k in range(1, 6)]
    assert stems(pair_up(paths("rgb", *colour), paths("depth", *depth)).depth) == depth


def test_if_most_pictures_have_no_depth_they_are_refused() -> None:
    colour = [f"{10 + k / 10:.3f}" for k in range(9)]
    with refused("10.300", "0.050 s", "6 of 9"):
        pair_up(paths("rgb", *colour), paths("depth", *colour[:3]))


def test_two_pictures_of_one_time_are_refused() -> None:
    with refused("1.50", "same time"):
        pair_up(paths("rgb", "1.5", "1.50", "1.6"), paths("depth", "1.5", "1.6"))


def test_a_single_picture_has_its_depth_and_no_rate() -> None:
    pairs = pair_up(paths("rgb", "4.5"), paths("depth", "4.4", "4.52", "9.0"))
    assert (stems(pairs.depth), pairs.rate_hz) == (["4.52"], None)


FOLDER = Path("clip/depth")


@pytest.mark.parametrize("m_per_count", [0.001, 0.0002, 0.00025, 0.0123])
def test_counts_times_the_scale_are_metres_and_nothing_read_stays_so(m_per_count: float) -> None:
    counts = np.array([[0, 1, 1000], [5000, 20000, 65535]], np.uint16)
    told = DepthCounts(FOLDER, m_per_count)(counts)
    metres = counts * m_per_count
    assert told.dtype == np.uint16
    assert told / 1000 == pytest.approx(np.where(metres <= 65.535, metres, 0.0), abs=0.0005001)


@pytest.mark.parametrize("m_per_count", [0.0, -0.001, float("nan"), float("inf")])
def test_a_scale_that_is_none_is_refused(m_per_count: float) -> None:
    with refused("--depth-scale", "above 0", f"{m_per_count:g}"):
        DepthCounts(FOLDER, m_per_count)


@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_pictures_of_other_depths_than_counts_are_refused(dtype: type) -> None:
    with refused(str(FOLDER), "16-bit", np.dtype(dtype).name):
        DepthCounts(FOLDER, 0.001)(np.ones((4, 5), dtype))


def test_a_scale_by_which_nobody_can_be_there_is_refused_with_the_one_that_fits() -> None:
    millimetres = np.full((30, 40), 4000, np.uint16)
    with refused("--depth-scale 1:", "4e+03 m", "--depth-scale 0.001?"):
        DepthCounts(FOLDER, 1.0).check_plausible(millimetres)
    with refused("--depth-scale 1e-05:", "--depth-scale 0.001?"):
        DepthCounts(FOLDER, 1e-5).check_plausible(millimetres)
    with refused("--depth-scale 0.001:", "--depth-scale 0.0002?"):
        DepthCounts(FOLDER, 0.001).check_plausible(np.full((30, 40), 50000, np.uint16))
    DepthCounts(FOLDER, 0.001).check_plausible(millimetres)
    DepthCounts(FOLDER, 1.0).check_plausible(np.zeros((30, 40), np.uint16))
