import io

import numba
import pytest
from rich.console import Console

from peopleboy.scenarios.compiling import announced_compiling


@pytest.mark.parametrize("is_terminal", [True, False])
def test_the_first_kernel_that_is_compiled_is_told_on_a_terminal(is_terminal):
    told = io.StringIO()
    with announced_compiling(Console(file=told, force_terminal=is_terminal, width=200)):
        for change in (1, 2):
            numba.njit(lambda x, change=change: x + change)(3)
    assert told.getvalue().count("compiling kernels of tests.scenarios.test_compiling") == is_terminal
    numba.njit(lambda x: x - 1)(3)
    assert told.getvalue().count("for this processor") == is_terminal
