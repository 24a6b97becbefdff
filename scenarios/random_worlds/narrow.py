"""Random worlds of a narrower kind: some ranges, shares and odds given, the others as ever."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from peopleboy.bad_input import BadInput, found_in
from peopleboy.scenarios.random_worlds.distribution import ODDS, RANGES, SHARES, Distribution, Range
from peopleboy.wording import hint


def narrowed(given: object) -> Distribution:
    """Give the distribution of random worlds with what is given in the place of its own.

    Args:
        given: by name of `RANGES` a number, or a pair within its limits; by name of `SHARES` one of its
            words; by name of `ODDS` how often, 0..1.

    Raises:
        BadInput: there is no such name, or its value is beyond the limits.
    """
    if not isinstance(given, Mapping):
        raise BadInput(f"{given!r}: must be a mapping of names to values, such as {{'people': [1, 2]}}")
    usual = Distribution()
    ranges, shares, odds = dict(usual.ranges), dict(usual.shares), dict(usual.odds)
    for name, value in given.items():
        with found_in(name):
            if name in RANGES:
                ranges[name] = _range(RANGES[name], value)
            elif name in SHARES:
                shares[name] = _share(SHARES[name], value)
            elif name in ODDS:
                odds[name] = (_odds(value), ODDS[name][1])
            else:
                raise BadInput(f"there is no such; {hint(str(name), [*RANGES, *SHARES, *ODDS])}")
    return Distribution(ranges=ranges, shares=shares, odds=odds)


def _range(usual: Range, value: Any) -> Range:
    bounds = list(value) if isinstance(value, tuple | list) else [value, value]
    fine = len(bounds) == 2 and all(is_number(bound, is_whole=usual.is_whole) for bound in bounds)
    if not fine or not usual.low <= bounds[0] <= bounds[1] <= usual.high:
        what = "a whole number" if usual.is_whole else "a number"
        unit = f" {usual.unit}" if usual.unit else ""
        raise BadInput(f"{value!r} must be {what} or a pair, within {usual.low:g} .. {usual.high:g}{unit}")
    return replace(usual, low=bounds[0], high=bounds[1])


def _share(usual: Mapping[str, float], value: Any) -> Mapping[str, float]:
    if value not in list(usual):
        raise BadInput(f"{value!r} must be one of {', '.join(usual)}")
    return {str(value): 1.0}


def _odds(value: Any) -> float:
    if not is_number(value, is_whole=False) or not 0.0 <= value <= 1.0:
        raise BadInput(f"{value!r} must be how often that is so, 0 .. 1")
    return float(value)


def is_number(value: object, *, is_whole: bool) -> bool:
    """Tell whether a value is a finite number, or a whole one."""
    if isinstance(value, bool):
        return False
    if isinstance(value, int | np.integer):
        return True
    return not is_whole and isinstance(value, float | np.floating) and math.isfinite(value)
