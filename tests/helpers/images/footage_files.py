"""Tiny footage for tests: a drawn person who walks, in every form that footage comes in."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

SIZE = (120, 160)


def walker(frame: int, size: tuple[int, int] = SIZE) -> NDArray[np.uint8]:
    """Draw a warm person in front of something colder, (H, W)."""
    unit = size[0] / 120
    x, image = (50 + 1.5 * frame) * unit, np.full(size, 60, np.uint8)

    def oval(v: float, a: float, b: float) -> None:
        centre, axes = (round(x), round(v * unit)), (round(a * unit), round(b * unit))
        cv2.ellipse(image, centre, axes, 0, 0, 360, 180, cv2.FILLED)

    oval(30, 5, 7)
    oval(55, 11, 20)
    cv2.rectangle(
        image, (round(x - 8 * unit), round(60 * unit)), (round(x + 8 * unit), round(96 * unit)), 180, -1
    )
    return image


def box(frame: int) -> tuple[float, float, float, float]:
    """Give the true box of the person, of the default size."""
    return 50 + 1.5 * frame - 11, 23.0, 22.0, 74.0


def write_folder(folder: Path, count: int = 12, suffix: str = "png", size: tuple[int, int] = SIZE) -> Path:
    """Write 8-bit pictures without leading zeros, so that only natural order is right."""
    folder.mkdir(parents=True)
    for frame in range(count):
        cv2.imwrite(str(folder / f"frame{frame + 1}.{suffix}"), walker(frame, size))
    return folder


def write_counts(folder: Path, count: int = 12) -> Path:
    """Write 16-bit pictures in hundredths of a kelvin: 20 degC and 31 degC."""
    folder.mkdir(parents=True)
    for frame in range(count):
        warm = walker(frame) > 100
        counts = np.where(warm, 30415, 29315).astype(np.uint16)
        cv2.imwrite(str(folder / f"{frame}.png"), counts)
    return folder


def write_video(path: Path, count: int = 12, rate: float = 25.0) -> Path:
    """Write a video that loses nothing."""
    film = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"FFV1"), rate, SIZE[::-1])
    for frame in range(count):
        film.write(cv2.cvtColor(walker(frame), cv2.COLOR_GRAY2BGR))
    film.release()
    return path


def write_empty(folder: Path, count: int = 3) -> Path:
    """Write pictures of nobody."""
    folder.mkdir(parents=True)
    for frame in range(count):
        cv2.imwrite(str(folder / f"frame{frame + 1}.png"), np.full(SIZE, 60, np.uint8))
    return folder
