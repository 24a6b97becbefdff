import numpy as np

from peopleboy.tracker.panoramic.foreground.elementary import exponential, logarithm


def test_the_logarithm_is_numpys_from_the_smallest_to_the_largest_numbers_and_0_of_1() -> None:
    numbers = np.geomspace(1e-37, 1e38, 2000).astype(np.float32)
    told = [logarithm(x) for x in numbers]
    np.testing.assert_allclose(told, np.log(numbers.astype(float)), rtol=3e-7, atol=1e-6)
    assert logarithm(np.float32(1.0)) == 0.0


def test_the_exponential_is_numpys_and_stays_finite_beyond_its_limits() -> None:
    numbers = np.linspace(-87, 87, 2001).astype(np.float32)
    told = [exponential(x) for x in numbers]
    np.testing.assert_allclose(told, np.exp(numbers.astype(float)), rtol=1e-5)
    assert exponential(np.float32(0.0)) == 1.0
    assert exponential(np.float32(200.0)) == exponential(np.float32(87.0))
    assert exponential(np.float32(-200.0)) == exponential(np.float32(-87.0))
