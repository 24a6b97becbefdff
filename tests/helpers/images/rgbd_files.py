"""Tiny RGB-D footage for tests: a block as broad as a person who walks, in colour and in depth."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from tests.helpers.depth_scene import Block, depth_of

PERSON_RGB = (200, 30, 30)


def depth_mm(frame: int) -> NDArray[np.uint16]:
    """Draw a frame's depth (H, W) [mm]."""
    return depth_of([Block(0.04 * frame - 0.3, 4.0)])


def colours(frame: int) -> NDArray[np.uint8]:
    """Draw a frame's colours (H, W, 3)."""
    depth = depth_mm(frame)
    picture = np.full((*depth.shape, 3), 120, np.uint8)
    picture[depth == 4000] = PERSON_RGB
    return picture


def write_rgbd(
    home: Path,
    count: int = 4,
    *,
    counts_per_mm: float = 1.0,
    stamps: Sequence[str] = (),
    depth_stamps: Sequence[str] = (),
) -> tuple[Path, Path]:
    """Write folders `rgb` and `depth`, with names of their own or without leading zeros, and give them."""
    colour, depth = home / "rgb", home / "depth"
    for folder in (colour, depth):
        folder.mkdir(parents=True)
    for k in range(count):
        name, depth_name = (names[k] if names else str(k + 1) for names in (stamps, depth_stamps))
        cv2.imwrite(str(colour / f"{name}.png"), colours(k)[..., ::-1])
        write_counts(depth / f"{depth_name}.png", depth_mm(k) * counts_per_mm)
    return colour, depth


def write_counts(path: Path, counts: NDArray[np.number]) -> None:
    """Write counts (H, W) as 16-bit ones."""
    assert cv2.imwrite(str(path), np.rint(counts).astype(np.uint16))
