import numpy as np
from numba import njit

from peopleboy.tracker.elementary import exponential, exponentials, logarithm


@njit
def logarithms(x):
    result = np.empty_like(x)
    for i in range(len(x)):
        result[i] = logarithm(x[i])
    return result


def test_the_logarithm_is_numpys_from_the_smallest_to_the_largest_numbers_and_0_of_1() -> None:
    numbers = np.exp(np.linspace(-87.0, 88.0, 500_001)).astype(np.float32)
    np.testing.assert_allclose(logarithms(numbers), np.log(numbers.astype(float)), rtol=3e-7, atol=1e-7)
    assert logarithm(np.float32(1.0)) == 0.0


def test_the_exponential_is_numpys_and_stays_finite_beyond_its_limits() -> None:
    numbers = np.linspace(-87.0, 87.0, 500_001).astype(np.float32)
    np.testing.assert_allclose(exponentials(numbers), np.exp(numbers.astype(float)), rtol=1.5e-7)
    assert exponential(np.float32(0.0)) == 1.0
    assert exponential(np.float32(200.0)) == exponential(np.float32(87.0))
    assert exponential(np.float32(-200.0)) == exponential(np.float32(-87.0))
    assert np.isnan(exponential(np.float32(np.nan)))


def test_a_caller_that_may_reorder_sums_does_not_pass_it_on() -> None:
    kernels = [
        njit(error_model="numpy", fastmath=kernel.targetoptions["fastmath"])(kernel.py_func)
        for kernel in (logarithm, exponential)
    ]
    log, exp = kernels

    @njit(fastmath=True)
    def freely(x):
        return exp(x) + log(x)

    freely(np.float32(2.0))
    for kernel in kernels:
        assert not any("vfmadd" in text for text in kernel.inspect_asm().values())


def test_what_is_worked_out_side_by_side_has_the_bits_of_each_alone() -> None:
    numbers = np.linspace(-30.0, 3.0, 101).astype(np.float32)
    assert np.array_equal(exponentials(numbers), [exponential(x) for x in numbers])
    positive = exponentials(numbers)
    assert np.array_equal(logarithms(positive), [logarithm(x) for x in positive])
