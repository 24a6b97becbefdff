"""Whether the temperatures of footage can be those of a place with people."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.grey import CENTIKELVIN, Radiometry

PLAUSIBLE_C: Final = (-100.0, 200.0)
"""Half of a picture is within: cameras see no sky colder, and nobody stands where half of it is hotter."""

_ZERO_K_C: Final = CENTIKELVIN[1]
_COUNTS_PER_K: Final = (100, 25, 10, 1)  # in which cameras write kelvin


def check_plausible(radiometry: Radiometry, values: NDArray[np.float32]) -> None:
    """Refuse temperatures that no place with people has, such as those of pixels in another unit.

    The median decides, so that dead pixels and empty borders do not count.

    Args:
        radiometry: what is known of the pixels.
        values: (H, W) what it makes of a picture; degC if they are known.

    Raises:
        BadInput: half of the pixels are colder, or hotter, than `PLAUSIBLE_C`.
    """
    if not radiometry.is_known or _is_plausible(values):
        return
    low, high = PLAUSIBLE_C
    raise BadInput(
        f"{_option(radiometry)}: pictures then hold {values.min():.0f}..{values.max():.0f} degC, and half of "
        f"each should be within {low:.0f}..{high:.0f}; {_advice(radiometry, values)}"
    )


def _is_plausible(values_c: NDArray[np.float32]) -> bool:
    low, high = PLAUSIBLE_C
    return low <= float(np.median(values_c)) <= high


def _option(radiometry: Radiometry) -> str:
    if radiometry.scale is not None:
        return "--scale {:g},{:g}".format(*radiometry.scale)
    return "--temperature-range {:g} {:g}".format(*(radiometry.span_c or ()))


def _advice(radiometry: Radiometry, values: NDArray[np.float32]) -> str:
    """Say which option would make these (H, W) plausible."""
    if radiometry.scale is None:
        return "is it kelvin? give degC" if _is_plausible(values + np.float32(_ZERO_K_C)) else "give degC"
    gain, offset = radiometry.scale
    counts = (values - np.float32(offset)) / np.float32(gain)
    for per_k in _COUNTS_PER_K:
        if _is_plausible(counts / np.float32(per_k) + np.float32(_ZERO_K_C)):
            scale = "centikelvin" if per_k == 100 else f"{1 / per_k:g},{_ZERO_K_C:g}"
            return f"is it --scale {scale}?"
    return "degC must be GAIN counts + OFFSET; without --scale, grey follows the scene's contrast"
