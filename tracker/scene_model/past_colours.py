"""Which colours what is not there any more had."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.scene_model.layers import Layers

Colours = NDArray[np.uint8]


class PastColours:
    """Remembers the colours of the background, and of what was taken for it until it was seen through."""

    def __init__(self) -> None:
        self._now: Colours | None = None
        self._past: Colours | None = None

    def update(self, colour: Colours | None, layers: Layers, time_s: float) -> Colours | None:
        """Take in the (H, W, C) colours of a frame, once its readings are sorted; give those of the past.

        Returns:
            (H, W, C); None without colours.
        """
        if colour is None:
            return None
        if self._now is None or self._past is None:
            self._now, self._past = colour.copy(), colour.copy()
            return self._past
        has_opened = layers.is_opened(time_s)
        self._past[has_opened] = self._now[has_opened]
        np.copyto(self._now, colour, where=(layers.back_seen_s == np.float32(time_s))[:, :, None])
        return self._past
