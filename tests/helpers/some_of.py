"""A few of many cases at once, and all of them with the thorough tests."""

from __future__ import annotations

from collections.abc import Iterable

import pytest


def some_of(cases: Iterable[object], every: int) -> list[object]:
    """Give cases for `parametrize`: the first of every so many is always tested, the others thoroughly."""
    return [
        case
        if k % every == 0
        else pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.thorough)
        for k, case in enumerate(cases)
    ]
