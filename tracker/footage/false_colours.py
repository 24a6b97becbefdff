"""False colours of thermal pictures: the palette, and the grey levels that it shows."""

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from peopleboy.tracker.footage.read_tiff import Raw

_ALIKE: Final = 12
"""Greatest difference of the channels of a grey picture, as of a compressed one."""
_NEAR: Final = 10.0
"""Mean distance to a palette [grey levels], over a picture, up to which the picture is of this palette."""
_SAMPLED_PX: Final = 5000

_MAPS: Final = (
    "AUTUMN",
    "CIVIDIS",
    "HOT",
    "INFERNO",
    "JET",
    "MAGMA",
    "PLASMA",
    "RAINBOW",
    "TURBO",
    "VIRIDIS",
)


@dataclass(frozen=True, slots=True, eq=False)
class Palette:
    """A palette of 256 colours, from cold to warm.

    Attributes:
        name: of the palette.
        colours: (256, 3) RGB.
    """

    name: str
    colours: NDArray[np.uint8]
    _tree: KDTree = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_tree", KDTree(self.colours.astype(np.float64)))

    def distance(self, colours: NDArray[np.uint8]) -> float:
        """Return the mean distance of colours (N, 3) to the palette."""
        return float(np.mean(self._tree.query(colours.astype(np.float64))[0]))

    def grey(self, picture: Raw) -> NDArray[np.uint8]:
        """Return the level (H, W) of the nearest colour for each pixel of a picture (H, W, 3)."""
        rgb = picture.astype(np.uint32)
        packed = rgb[..., 0] << 16 | rgb[..., 1] << 8 | rgb[..., 2]
        codes, where = np.unique(packed, return_inverse=True)
        colours = np.stack([codes >> 16, codes >> 8 & 255, codes & 255], axis=1)
        levels = self._tree.query(colours.astype(np.float64))[1].astype(np.uint8)
        return np.asarray(levels[where].reshape(packed.shape))


@lru_cache(maxsize=1)
def palettes() -> tuple[Palette, ...]:
    """Return the known palettes: OpenCV's, and ironbow."""
    grey = np.arange(256, dtype=np.uint8)[:, None]
    maps = {name.lower(): cv2.applyColorMap(grey, getattr(cv2, f"COLORMAP_{name}")) for name in _MAPS}
    known = [Palette(name, np.ascontiguousarray(colours[:, 0, ::-1])) for name, colours in maps.items()]
    return (*known, Palette("ironbow", ironbow()))


def ironbow() -> NDArray[np.uint8]:
    """Return the colours (256, 3) RGB from black over violet, red and yellow to white.

    As gnuplot's default palette, red is the root and green the cube of the level, and blue is a sine; white
    is blended in at the end.
    """
    level = np.linspace(0.0, 1.0, 256)
    blue = np.maximum(np.sin(2.0 * np.pi * level), 0.0) + np.clip((level - 0.8) / 0.2, 0.0, 1.0)
    return np.rint(255.0 * np.stack([np.sqrt(level), level**3, np.minimum(blue, 1.0)], axis=1)).astype(
        np.uint8
    )


def find_palette(picture: Raw) -> Palette | None:
    """Return the palette that the colours of a picture (H, W, 3) are of; None if they are of none."""
    colours = picture.reshape(-1, 3)
    colours = colours[:: max(len(colours) // _SAMPLED_PX, 1)]
    best = min(palettes(), key=lambda one: one.distance(colours))
    return best if best.distance(colours) < _NEAR else None


class FalseColours:
    """Converts pictures to one channel, by the palette of the first coloured one."""

    def __init__(self) -> None:
        self._palette: Palette | None = None
        self._is_coloured = False

    def grey(self, picture: Raw, notes: list[str]) -> NDArray[Any]:
        """Return the pixels (H, W) of a picture (H, W) or (H, W, 3); without a palette, their brightness."""
        if picture.ndim == 2:
            return picture
        if not self._is_coloured and _is_coloured(picture):
            self._is_coloured, self._palette = True, find_palette(picture)
            notes.append(
                "pictures are coloured and were turned to grey; false colours need not keep warm above cold"
                if self._palette is None
                else f"pictures have the false colours {self._palette.name}, which were turned to grey"
            )
        if self._palette is not None:
            return self._palette.grey(picture)
        return np.asarray(cv2.cvtColor(np.ascontiguousarray(picture), cv2.COLOR_RGB2GRAY))


def _is_coloured(picture: Raw) -> bool:
    return int(np.ptp(picture[::4, ::4].astype(np.int16), axis=2).max()) > _ALIKE
