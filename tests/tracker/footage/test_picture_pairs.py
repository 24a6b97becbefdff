from pathlib import Path

import numpy as np
import pytest

from peopleboy.tracker.footage.picture_pairs import pair_up
from tests.helpers.calls.refused import refused


def paths(folder: str, *names: str) -> list[Path]:
    return [Path(folder) / f"{name}.png" for name in names]


def stems(found: list[Path]) -> list[str]:
    return [path.stem for path in found]


def test_names_that_are_no_times_go_together_by_their_order() -> None:
    pairs = pair_up(paths("rgb", "a1", "a2"), paths("depth", "d7", "d9"))
    assert (stems(pairs.colour), stems(pairs.depth)) == (["a1", "a2"], ["d7", "d9"])
    assert pairs.time_s is None
    assert pairs.rate_hz is None


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
def test_depth_that_is_off_by_more_than_half_a_pictures_time_is_refused(number: int, away_s: float) -> None:
    colour = [f"{10 + k / 10:.3f}" for k in range(9)]
    depth = [f"{10 + k / 10 + away_s * (k == number):.3f}" for k in range(9)]
    with refused(f"rgb/{colour[number]}.png", "0.050 s", "0.060 s"):
        pair_up(paths("rgb", *colour), paths("depth", *depth))
    near = [f"{10 + k / 10 + 0.05:.3f}" for k in range(9)]
    assert len(pair_up(paths("rgb", *colour), paths("depth", *near)).depth) == 9


def test_how_many_pictures_have_no_depth_is_told() -> None:
    colour = [f"{10 + k / 10:.3f}" for k in range(9)]
    with refused("10.300", "6 of 9"):
        pair_up(paths("rgb", *colour), paths("depth", *colour[:3]))


def test_two_pictures_of_one_time_are_refused() -> None:
    with refused("1.50", "same time"):
        pair_up(paths("rgb", "1.5", "1.50", "1.6"), paths("depth", "1.5", "1.6"))


def test_a_single_picture_has_its_depth_and_no_rate() -> None:
    pairs = pair_up(paths("rgb", "4.5"), paths("depth", "4.4", "4.52", "9.0"))
    assert (stems(pairs.depth), pairs.rate_hz) == (["4.52"], None)
