"""Clips as other cameras and recorders would show them, by which robustness is measured."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.footage.real_clips import RealClip
from peopleboy.tracker.footage import false_colours
from peopleboy.tracker.footage.image_sequences import open_footage

Picture = NDArray[np.uint8]

BAR: Final = 0.125
"""Height of each of the two bars of a letterbox, in heights of the picture."""
_JPEG: Final = ".jpg"


def black_hot(picture: Picture) -> Picture:
    """Invert a picture: warm is dark."""
    return np.asarray(255 - picture, np.uint8)


def ironbow(picture: Picture) -> Picture:
    """Return false colours (H, W, 3) BGR of a picture (H, W)."""
    return np.ascontiguousarray(false_colours.ironbow()[picture][..., ::-1])


def letterbox(picture: Picture) -> Picture:
    """Add black bars above and below a picture."""
    bar = round(BAR * picture.shape[0])
    return np.pad(picture, ((bar, bar), (0, 0)))


def _same(picture: Picture) -> Picture:
    return picture


ALTERATIONS: Final[Mapping[str, Callable[[Picture], Picture]]] = {
    "black-hot": black_hot,
    "JPEG 30": _same,
    "half rate": _same,
    "ironbow": ironbow,
    "letterbox": letterbox,
}
"""Alterations of pictures (H, W); quality and rate are altered as the pictures are written."""


def altered_name(clip: str, alteration: str) -> str:
    """Return the name of a clip that is altered."""
    return f"{clip}, {alteration}"


def alter(clip: RealClip, name: str, home: Path) -> RealClip:
    """Write an altered copy of a clip to a new folder below `home`, and open it."""
    folder = home / altered_name(clip.name, name)
    folder.mkdir(parents=True)
    step = 2 if name == "half rate" else 1
    options = [cv2.IMWRITE_JPEG_QUALITY, 30] if name == "JPEG 30" else []
    suffix = _JPEG if options else ".png"
    height = 0
    for number, raw in enumerate(open_footage(clip.folder)):
        if number == clip.frames:
            break
        picture = _grey(raw)
        height = picture.shape[0]
        if number % step == 0:
            path = folder / f"{number // step + 1:06d}{suffix}"
            cv2.imwrite(str(path), ALTERATIONS[name](picture), options)
    truth = clip.given.truth
    truth = truth.take((truth.frame - 1) % step == 0)
    down = round(BAR * height) if name == "letterbox" else 0
    moved = replace(truth, frame=(truth.frame - 1) // step + 1, box=truth.box + np.array([0, down, 0, 0]))
    frames = (clip.frames + step - 1) // step
    return RealClip(folder, replace(clip.given, truth=moved), frames, clip.step * step)


def _grey(raw: NDArray[Any]) -> Picture:
    return np.asarray(raw if raw.ndim == 2 else cv2.cvtColor(raw, cv2.COLOR_RGB2GRAY), np.uint8)
