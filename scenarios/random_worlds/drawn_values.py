"""Read the sampled values of a random world back from its scenario."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

import numpy as np

from peopleboy.scenarios.files.people import PersonSpec, make_config
from peopleboy.scenarios.files.validation import validated
from peopleboy.scenarios.random_worlds.distribution import Distribution, Range
from peopleboy.sim.people.appearance.finisher import appearance_stream, draw_bearing

Values = dict[str, list[float] | list[str]]
"""Sampled values by name; a name may have any number of values."""

_BARS: Final = 6
_SUN: Final = {"sun_azimuth": "azimuth_deg", "sun_elevation": "elevation_deg", "sun_warms": "warms_k"}
_CAMERA: Final[Mapping[str, str]] = {
    "pitch": "pitch_deg",
    "vertical_fov": "vertical_fov_deg",
    "blur": "blur_px",
    "netd": "netd_k",
    "fixed_pattern": "fixed_pattern_k",
    "dead_pixels": "dead_pixels",
    "column_noise": "column_noise_k",
    "vignetting": "vignetting_k",
    "drift": "offset_drift_k_per_min",
    "sharpening": "sharpening",
    "coring": "coring_k",
    "gain": "gain",
    "gain_follows": "gain_follows_s",
    "tail": "tail_percent",
    "least_span": "least_span_k",
    "plateau": "plateau_percent",
    "linear_share": "linear_share",
    "shutter_every": "shutter_every_s",
    "jpeg_quality": "jpeg_quality",
}
"""Keys of the thermal camera by the names of sampled values."""


def drawn_values(played: Mapping[str, Any]) -> Values:
    """List the values that were sampled for a world.

    Args:
        played: the resolved scenario as plain data, as in a run's scenario.yaml.
    """
    place, robot = played["place"], played["robot"]
    warm, camera = place["temperatures"], robot["cameras"]["thermal"]
    people, things = played["people"], played["things"]
    pauses = [point for person in people for point in person["path"] if point["pause_s"] > 0.0]
    air = warm["surroundings_c"]
    size = place["kind"] if place["kind"] in ("room", "street") else "corridor"
    lengths = [place[key] for key in ("length_m", "first_m", "second_m", "stem_m", "bar_m") if key in place]
    return {
        "place": [place["kind"]],
        f"{size}_length": lengths,
        f"{size}_width": [place["width_m"]],
        "ceiling": [place["height_m"]],
        "doors": [len(place["doors"])],
        "door": ["open" if door["open"] else "closed" for door in place["doors"]],
        "air": [air],
        **({"houses": [place["houses"]], "sky": [place["sky_c"] - air]} if size == "street" else {}),
        **{name: [place["sun"][key]] for name, key in _SUN.items() if place.get("sun")},
        "floor_over_air": [warm["floor_c"] - air],
        "walls_over_air": [warm["walls_c"] - air],
        "ceiling_over_air": [warm["ceiling_c"] - air],
        "wall_over_others": [other - warm["walls_c"] for other in warm["single_walls_c"].values()],
        "things": [len(things)],
        "thing": [thing["kind"] for thing in things],
        "emissivity": [thing["emissivity"] for thing in things],
        "people": [len(people)],
        "sex": [person["sex"] for person in people],
        "top": [person["clothes"]["top"] for person in people],
        "bottom": [person["clothes"]["bottom"] for person in people],
        "hair": [person["clothes"]["hair"] for person in people],
        **{key: [person[key] for person in people] for key in ("age", "gait", "arms", "equipment")},
        **_bearings(people, played["drawn"]["seed"]),
        "points": [len(person["path"]) for person in people],
        "speed": _speeds(person for person in people if person["gait"] != "running"),
        "running_speed": _speeds(person for person in people if person["gait"] == "running"),
        "pause": [point["pause_s"] for point in pauses],
        "posture": [point["posture"] for point in pauses],
        "camera_height": [camera["mount_m"][2]],
        **{name: [camera[key]] for name, key in _CAMERA.items() if key in camera},
        "robot": ["drives" if robot["behaviour"] == "scripted" else "stands"],
        "drive_speed": [one["linear_m_s"] for one in robot["commands"] if one["linear_m_s"] != 0.0],
        "drive_turn": [one["angular_deg_s"] for one in robot["commands"] if one["angular_deg_s"] != 0.0],
        "light": [step["level"] for step in played["lights"]],
    }


def _speeds(people: Iterable[Mapping[str, Any]]) -> list[float]:
    return [point["speed_m_s"] for person in people for point in person["path"]]


def _bearings(people: Sequence[Mapping[str, Any]], seed: int) -> dict[str, list[str]]:
    """Sample again what a world samples outside its scenario: carried objects, coats, headgear, hands."""
    configs = [make_config(validated(PersonSpec, person)) for person in people]
    drawn = [draw_bearing(config, appearance_stream(seed, config.name)) for config in configs]
    return {
        "carried": [outfit.carried for outfit, _ in drawn],
        "coat": [outfit.coat for outfit, _ in drawn],
        "headgear": [outfit.headgear for outfit, _ in drawn],
        "hands": [hold for _, manner in drawn for hold in manner.holds],
    }


def histograms(worlds: Sequence[Values], distribution: Distribution) -> list[tuple[str, str, str]]:
    """Count the sampled values of many worlds.

    Args:
        worlds: values of each world.
        distribution: the distribution that they were sampled from.

    Returns:
        For each value: its description, its range with unit or the number of samples, and the counts as text,
        for each sixth of the range or for each category.
    """
    names = dict.fromkeys(name for world in worlds for name in world)
    rows = []
    for name in names:
        values = [value for world in worlds for value in world.get(name, [])]
        spread = distribution.ranges.get(name)
        if name in distribution.shares or spread is None or any(isinstance(value, str) for value in values):
            rows.append((name, f"{len(values)} drawn", _counts(map(str, values))))
        else:
            rows.append((spread.what, _span(spread), _bars(np.array(values, np.float64), spread)))
    return rows


def _counts(values: Iterable[str]) -> str:
    return ", ".join(f"{value.replace('_', ' ')} {count}" for value, count in Counter(values).most_common())


def _bars(values: Any, spread: Range) -> str:
    """Count values in equal bins of their range; whole numbers with a small range get one bin each."""
    if spread.low == spread.high:
        return str(len(values))
    bars = int(spread.high - spread.low) + 1 if spread.is_whole and spread.high <= 12 else _BARS
    edges = np.linspace(spread.low, spread.high + spread.is_whole, bars + 1)
    inside = np.clip(values, spread.low, np.nextafter(edges[-1], -math.inf))
    return " · ".join(str(int(count)) for count in np.histogram(inside, edges)[0])


def _span(spread: Range) -> str:
    return f"{spread.low:g} to {spread.high:g} {spread.unit}".rstrip()
