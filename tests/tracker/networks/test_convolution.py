import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from peopleboy.tracker.networks.convolution import Workspace, convolve, convolve_tiles, tile_kernel

NONE = np.zeros(1, np.float32)


def drawn(seed: int, *shape: int) -> NDArray[np.float32]:
    return np.random.default_rng(seed).standard_normal(shape).astype(np.float32)


def filtered(plane: NDArray[np.float32], kernel: NDArray[np.float32]) -> NDArray[np.float32]:
    told = cv2.filter2D(plane, -1, kernel, borderType=cv2.BORDER_CONSTANT)
    return np.maximum(np.asarray(told, np.float32), 0.0)


@pytest.mark.parametrize("side", [1, 3, 5])
@pytest.mark.parametrize("stride", [1, 2])
@pytest.mark.parametrize("shape", [(9, 7), (6, 4), (1, 3)])
def test_a_kernel_is_a_filter_of_what_is_positive_then(
    side: int, stride: int, shape: tuple[int, int]
) -> None:
    plane, kernel = drawn(0, *shape), drawn(1, side, side)
    ours = convolve(plane[None, ..., None], kernel.reshape(-1, 1), NONE, side, stride, Workspace())
    np.testing.assert_allclose(ours[0, ..., 0], filtered(plane, kernel)[::stride, ::stride], atol=1e-5)


def test_planes_are_added_up_with_what_is_always_there() -> None:
    planes, kernel, bias = drawn(0, 6, 5, 2), drawn(1, 9 * 2, 4), drawn(2, 4)
    ours = convolve(planes[None], kernel, bias, 3, 1, Workspace())[0]
    square = kernel.reshape(3, 3, 2, 4)
    for number in range(4):
        parts = [
            cv2.filter2D(planes[..., k], -1, square[..., k, number], borderType=cv2.BORDER_CONSTANT)
            for k in range(2)
        ]
        np.testing.assert_allclose(ours[..., number], np.maximum(sum(parts) + bias[number], 0.0), atol=1e-5)


@given(st.integers(1, 9), st.integers(1, 9), st.integers(1, 5), st.integers(1, 6), st.integers(0, 9))
def test_tiles_give_the_same_with_fewer_products(
    rows: int, columns: int, deep: int, wide: int, seed: int
) -> None:
    planes = drawn(seed, 3, rows, columns, deep)
    kernel, bias = drawn(seed + 1, 9 * deep, wide), drawn(9, wide)
    whole = convolve(planes, kernel, bias, 3, 1, Workspace())
    by_tiles = convolve_tiles(planes, tile_kernel(kernel), bias, Workspace())
    np.testing.assert_allclose(by_tiles, whole, atol=1e-4)


def test_a_desk_that_was_used_before_gives_the_same() -> None:
    planes, desk = drawn(0, 2, 12, 9, 4), Workspace()
    first, second = drawn(1, 36, 8), drawn(2, 72, 5)
    told = []
    for _ in range(2):
        here = convolve(planes, first, np.zeros(8, np.float32), 3, 2, desk)
        told.append(convolve_tiles(here, tile_kernel(second), np.ones(5, np.float32), desk).copy())
    fresh = convolve(planes, first, np.zeros(8, np.float32), 3, 2, Workspace())
    np.testing.assert_array_equal(told[0], told[1])
    np.testing.assert_array_equal(
        told[0], convolve_tiles(fresh, tile_kernel(second), np.ones(5, np.float32), Workspace())
    )


@pytest.mark.parametrize("count", [2, 9])
def test_each_of_many_is_as_it_is_alone(count: int) -> None:
    planes = drawn(0, count, 48, 36, 24)  # so many that not all are worked with at once
    strided, close, bias = drawn(1, 9 * 24, 48), drawn(2, 9 * 24, 32), drawn(3, 48)
    together = convolve(planes, strided, bias, 3, 2, Workspace()).copy()
    by_tiles = convolve_tiles(planes, tile_kernel(close), bias[:32], Workspace())
    for number in range(count):
        one = planes[number : number + 1]
        np.testing.assert_allclose(
            together[number], convolve(one, strided, bias, 3, 2, Workspace())[0], rtol=1e-4, atol=1e-4
        )
        np.testing.assert_allclose(
            by_tiles[number],
            convolve_tiles(one, tile_kernel(close), bias[:32], Workspace())[0],
            rtol=1e-4,
            atol=1e-4,
        )
