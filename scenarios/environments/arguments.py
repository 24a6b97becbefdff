"""What an environment takes for its arguments and actions, and what it refuses."""

from __future__ import annotations

import reprlib
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.robot.robot_config import RobotConfig

SMALLEST_PX: Final = (64, 48)
LARGEST_PX: Final = (1280, 960)


def check_word(name: str, word: str | None, known: Sequence[str | None]) -> None:
    """Refuse a word that is none of those known.

    Raises:
        BadInput: it is none.
    """
    if word not in known:
        raise BadInput(f"{name} {word!r}: there is no such; choose from {', '.join(map(str, known))}")


def check_size(size: tuple[int, int]) -> None:
    """Refuse a width and height [px] that images cannot have.

    Raises:
        BadInput: it is one.
    """
    is_fine = (
        isinstance(size, tuple | list)
        and len(size) == 2
        and all(
            isinstance(got, int) and low <= got <= high
            for got, low, high in zip(size, SMALLEST_PX, LARGEST_PX, strict=True)
        )
    )
    if not is_fine:
        (narrow, flat), (wide, tall) = SMALLEST_PX, LARGEST_PX
        raise BadInput(
            f"image_size {size!r} must be width and height [px], {narrow} x {flat} to {wide} x {tall}"
        )


def shown_cameras(cameras: Sequence[str] | None, observation: str, robot: RobotConfig) -> tuple[str, ...]:
    """Return the names of the cameras whose images are shown; None for all.

    Raises:
        BadInput: a robot has no such cameras, or the observation has no images.
    """
    if cameras is None:
        return tuple(robot.cameras)
    if observation != "pixels":
        raise BadInput(f"cameras {cameras!r}: observation {observation!r} has no images; leave them out")
    if isinstance(cameras, str) or not cameras or len(set(cameras)) < len(cameras):
        raise BadInput(f"cameras {cameras!r} must be one or more different names, such as ('thermal',)")
    for name in cameras:
        check_word("cameras", name, tuple(robot.cameras))
    return tuple(cameras)


def check_actions(actions: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return the two shares of each of some actions, clipped: (G, 2).

    Raises:
        BadInput: they have not that shape, or not all numbers are finite.
    """
    try:
        shares = np.asarray(actions, np.float64)
    except (TypeError, ValueError) as error:
        raise BadInput(
            f"actions must be {shape}, two finite numbers each, got {reprlib.repr(actions)}"
        ) from error
    if shares.shape != shape:
        raise BadInput(f"actions of shape {shares.shape}: must be {shape}, two finite numbers each")
    if not np.isfinite(shares).all():
        wrong = next(row for row in shares.reshape(-1, 2).tolist() if not np.isfinite(row).all())
        raise BadInput(f"action {wrong} must be two finite numbers: shares of speed and turn rate")
    return np.clip(shares, -1.0, 1.0).reshape(-1, 2)
