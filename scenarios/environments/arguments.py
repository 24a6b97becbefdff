"""Check the arguments, actions and options of an environment."""

from collections.abc import Mapping, Sequence
from reprlib import repr as shown
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from peopleboy.bad_input import BadInput, found_in
from peopleboy.scenarios.files.variation import LIMITS, SWITCHES, WHOLE
from peopleboy.scenarios.random_worlds.distribution import Distribution, is_number, narrowed
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.wording import hint

SMALLEST_PX: Final = (64, 48)
LARGEST_PX: Final = (1280, 960)


def check_word(name: str, word: str | None, known: Sequence[str | None]) -> None:
    """Refuse an unknown word.

    Raises:
        BadInput: the word is not in `known`.
    """
    if not (word is None or isinstance(word, str)) or word not in known:
        raise BadInput(f"unknown {name} {shown(word)}; choose from {', '.join(map(str, known))}")


def check_size(size: tuple[int, int]) -> None:
    """Refuse an invalid width and height [px] of images.

    Raises:
        BadInput: the size is invalid.
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
            f"image_size {shown(size)} must be width and height [px], {narrow} x {flat} to {wide} x {tall}"
        )


def whole_number(name: str, value: Any, low: int, high: int) -> int:
    """Return a whole number, NumPy's included, within limits.

    Raises:
        BadInput: it is no such number.
    """
    is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not is_whole or not low <= value <= high:
        raise BadInput(f"{name} {shown(value)} must be a whole number from {low} to {high}")
    return int(value)


def shown_cameras(cameras: Sequence[str] | None, observation: str, robot: RobotConfig) -> tuple[str, ...]:
    """Return the names of the cameras in the observation; all cameras if `cameras` is None.

    Raises:
        BadInput: the robot lacks one of the cameras, or the observation has no images.
    """
    if cameras is None:
        return tuple(robot.cameras)
    if observation != "pixels":
        raise BadInput(f"cameras {shown(cameras)}: observation {observation!r} has no images; leave them out")
    is_list = isinstance(cameras, tuple | list) and all(isinstance(name, str) for name in cameras)
    if not is_list or not cameras or len(set(cameras)) < len(cameras):
        raise BadInput(f"cameras {shown(cameras)} must be one or more different names, such as ('thermal',)")
    for name in cameras:
        check_word("cameras", name, tuple(robot.cameras))
    return tuple(cameras)


def check_actions(actions: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return actions as shares of the speed limits, clipped to -1..1: (G, 2).

    Raises:
        BadInput: the actions do not have this shape, or contain NaN or infinity.
    """
    try:
        shares = np.asarray(actions, np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise BadInput(f"actions must be {shape}, two finite numbers each, got {shown(actions)}") from error
    if shares.shape != shape:
        raise BadInput(f"actions of shape {shares.shape}: must be {shape}, two finite numbers each")
    if not np.isfinite(shares).all():
        wrong = next(row for row in shares.reshape(-1, 2).tolist() if not np.isfinite(row).all())
        raise BadInput(f"action {wrong} must be two finite numbers: shares of speed and turn rate")
    return np.clip(shares, -1.0, 1.0).reshape(-1, 2)


WORLD: Final = "world"


def check_options(options: Mapping[str, Any], *, draws_worlds: bool = False) -> None:
    """Refuse unknown options and values outside their limits.

    Args:
        options: values by name.
        draws_worlds: whether worlds are random, so that `world` is valid.

    Raises:
        BadInput: an option is invalid; the error states key, value and limits.
    """
    if not isinstance(options, Mapping):
        raise BadInput(f"options: must be a mapping of names to values, got {shown(options)}")
    for key, value in options.items():
        if key == WORLD and draws_worlds:
            world_of(options)
            continue
        if key == WORLD:
            raise BadInput("options: world needs random worlds; make the environment with scenario=None")
        if key not in LIMITS:
            raise BadInput(f"options: unknown key {shown(key)}; {hint(str(key), [*LIMITS, WORLD])}")
        low, high = LIMITS[key]
        bounds = value if isinstance(value, tuple | list) else (value, value)
        is_fine = len(bounds) == 2 and all(
            _is_number(bound, key) and low <= bound <= high for bound in bounds
        )
        if not is_fine or bounds[0] > bounds[1]:
            what = "a whole number" if key in WHOLE else "a number"
            raise BadInput(
                f"options: {key} {shown(value)} must be {what} or a rising pair, within {low:g} .. {high:g}"
            )


def world_of(options: Mapping[str, Any]) -> Distribution | None:
    """Return the distribution of random worlds that the options ask for; None for the default distribution.

    Raises:
        BadInput: a name is unknown, or its value is outside the limits.
    """
    if WORLD not in options:
        return None
    with found_in("options", WORLD):
        return narrowed(options[WORLD])


def _is_number(value: object, key: str) -> bool:
    if isinstance(value, bool):
        return key in SWITCHES
    return is_number(value, is_whole=key in WHOLE)
