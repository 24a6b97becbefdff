"""Numbers rounded to short binary fractions, finer than a screen shows.

Rerun packs with LZ4, which finds only bytes that repeat; the last digits of measured numbers never do. A body
so rounded takes half the bytes.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

# Powers of two: other steps leave long binary fractions.
PIXEL_STEP: Final = 1 / 4
METRE_STEP: Final = 1 / 128
TURN_STEP: Final = 1 / 128  # of a quaternion's parts: within half a degree


def rounded(values: NDArray[np.floating], step: float) -> NDArray[np.float32]:
    """Round values of any shape to multiples of a step, which is a power of two."""
    # Adding zero makes -0 into 0, whose bytes differ.
    short: NDArray[np.float32] = (np.rint(values / step) * step + 0.0).astype(np.float32)
    return short
