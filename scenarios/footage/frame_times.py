"""When the images of a sequence were taken."""

from collections.abc import Sequence

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.footage.options import (
    TrackOptions,
)
from peopleboy.tracker.footage.time_stamps import read_time_stamps


def given_times(options: TrackOptions, names: Sequence[str]) -> list[float] | None:
    """Return the times of images in a file of time stamps, from 0; None without such a file."""
    if options.timestamps is None:
        return None
    if options.rate_hz is not None:
        raise BadInput("--rate-hz: --timestamps has the images' times; leave one of them out")
    times = read_time_stamps(options.timestamps, names)
    return [float(time) for time in times - times[0]] if len(times) else []


def rate_of(times_s: Sequence[float] | None) -> float | None:
    """Return the images per second, from the median interval."""
    return 1.0 / float(np.median(np.diff(times_s))) if times_s is not None and len(times_s) > 1 else None


def time_of(
    options: TrackOptions,
    times_s: Sequence[float] | None,
    offsets: Sequence[float] | None,
    number: int,
    rate_hz: float,
) -> float:
    """Return the time of an image: as given, or by the frame rate, with the gaps in its number."""
    if times_s is None:
        return (number if offsets is None else offsets[number]) / rate_hz
    if number >= len(times_s):
        raise BadInput(f"{options.timestamps}: has {len(times_s)} times, but there are more images")
    return times_s[number]
