"""COCO's run-length encoding of a mask, as text."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_BITS, _OFFSET = 5, 48


def run_lengths(mask: NDArray[np.bool_]) -> list[int]:
    """Count pixels (H, W) column by column: those outside the mask, inside, outside, ...

    The first count is 0 if the first pixel is inside; all add up to H W.
    """
    flat = mask.ravel(order="F")
    edges = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    lengths = np.diff(np.concatenate([[0], edges, [flat.size]])).tolist()
    return [0, *lengths] if flat[0] else lengths


def encode_lengths(lengths: list[int]) -> str:
    """Write run lengths as pycocotools does: from the fourth on as differences to those two before.

    Each number is cut into groups of five bits, the lowest first, with a sixth bit if more follow.
    """
    steps = [n if k < 3 else n - lengths[k - 2] for k, n in enumerate(lengths)]
    return "".join(_encode_number(step) for step in steps)


def _encode_number(number: int) -> str:
    text = ""
    while True:
        group = number & 0x1F
        number >>= _BITS
        # The highest bit of the last group is the sign.
        is_last = number == (-1 if group & 0x10 else 0)
        text += chr(_OFFSET + (group if is_last else group | 0x20))
        if is_last:
            return text
