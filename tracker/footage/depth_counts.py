"""Depth pictures that others recorded, in millimetres."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.read_picture import Raw

MILLIMETRES: Final = 0.001
TUM: Final = 0.0002
"""Metres a count stands for: what most sensors' drivers write, and the TUM RGB-D benchmark."""

PLAUSIBLE_M: Final = (0.2, 30.0)
"""Half of what is read in a picture with people is within."""


class DepthCounts:
    """Turns counts into millimetres.

    Args:
        folder: of the pictures, as the user knows it.
        m_per_count: metres that a count stands for; 0 counts are no reading.

    Raises:
        BadInput: it is not above 0 and finite.
    """

    def __init__(self, folder: Path, m_per_count: float) -> None:
        if not 0.0 < m_per_count < math.inf:
            raise BadInput(
                f"--depth-scale must be above 0, metres per count such as {MILLIMETRES}, got {m_per_count:g}"
            )
        self._folder, self.m_per_count = folder, m_per_count
        millimetres = np.rint(1000.0 * m_per_count * np.arange(65536.0))
        self._millimetres = np.where(millimetres <= 65535.0, millimetres, 0.0).astype(np.uint16)

    def __call__(self, picture: Raw) -> NDArray[np.uint16]:
        """Give depths (H, W) [mm] of counts; 0 where nothing is read, or what is farther than 65.5 m.

        Raises:
            BadInput: the picture is none of 16-bit counts.
        """
        if picture.dtype != np.uint16:
            raise BadInput(
                f"{self._folder}: depth pictures must be 16-bit counts (PNG or TIFF), got {picture.dtype}"
            )
        return np.asarray(self._millimetres[picture])

    def check_plausible(self, picture: Raw) -> None:
        """Refuse a scale by which the counts (H, W) of a picture are no depths of a place with people.

        Raises:
            BadInput: half of what is read is nearer, or farther, than `PLAUSIBLE_M`.
        """
        read = picture[picture > 0]
        if not len(read) or _is_plausible(median := float(np.median(read)), self.m_per_count):
            return
        fitting = [scale for scale in (MILLIMETRES, TUM) if _is_plausible(median, scale)]
        advice = f"; is it --depth-scale {fitting[0]:g}?" if fitting else ""
        low, high = PLAUSIBLE_M
        raise BadInput(
            f"--depth-scale {self.m_per_count:g}: half of what is read in {self._folder} is then beyond "
            f"{median * self.m_per_count:.3g} m, which should be {low:g}..{high:g}{advice}"
        )


def _is_plausible(counts: float, m_per_count: float) -> bool:
    low, high = PLAUSIBLE_M
    return low <= counts * m_per_count <= high
