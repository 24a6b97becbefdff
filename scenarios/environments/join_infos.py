"""What many environments say beside their observations, as gymnasium's vector environments have it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Infos = dict[str, Any]


def join_infos(infos: Sequence[Infos | None]) -> Infos:
    """Make arrays (B,) of B infos, at once where gymnasium's `VectorEnv` takes one after the other.

    Each key of any of them has an array of its values, and beside it, as `_key`, one of who has it; numbers
    are arrays of numbers, 0 for those who have none, dicts are joined in the same way, all else is objects.

    Args:
        infos: None for an environment that says nothing.
    """
    found: Infos = {}
    for key in dict.fromkeys(key for info in infos if info is not None for key in info):
        has = [info is not None and key in info for info in infos]
        values = [
            info[key] if is_there and info is not None else None
            for info, is_there in zip(infos, has, strict=True)
        ]
        first = values[has.index(True)]
        if isinstance(first, dict):
            found[key] = join_infos(values)
        else:
            found[key] = _array(values, first)
        found[f"_{key}"] = np.array(has)
    return found


def _array(values: list[Any], first: object) -> NDArray[Any]:
    if type(first) in (int, float, bool):
        return np.array([type(first)() if value is None else value for value in values])
    array = np.empty(len(values), object)
    for number, value in enumerate(values):
        array[number] = value
    return array
