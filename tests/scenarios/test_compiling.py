import io

import numba
from rich.console import Console

from peopleboy.scenarios.compiling import announced_compiling


def test_the_first_kernel_that_is_compiled_is_announced() -> None:
    printed = io.StringIO()
    with announced_compiling(Console(file=printed, width=200)):
        for change in (1, 2):
            numba.njit(lambda x, change=change: x + change)(3)
    assert printed.getvalue().count("compiling kernels of tests.scenarios.test_compiling") == 1
    numba.njit(lambda x: x - 1)(3)
    assert printed.getvalue().count("for this processor") == 1
