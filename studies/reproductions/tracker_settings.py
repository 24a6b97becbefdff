"""Settings of the compared trackers: a base, with some of its settings changed."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from operator import attrgetter
from typing import Any

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.reproductions.contour.contour_config import (
    DepthOrderConfig,
    HeightConfig,
    StayBehindConfig,
    TrackerConfig,
)
from peopleboy.tracker.reproductions.contour.contour_tracker import ContourTracker
from peopleboy.tracker.reproductions.contour.single_filter import SingleFilter
from peopleboy.tracker.reproductions.contour.variants import (
    CONTOUR,
    PAPER,
    THESIS,
    THESIS_COLOUR,
    THESIS_OCCLUSION,
    VARIANTS,
)
from peopleboy.tracker.trackers import Tracker

Value = float | int | str | bool | tuple[float, ...] | None
Changes = tuple[tuple[str, Value], ...]

SINGLE = ("thesis-single", "paper-single")
"""Trackers of a single person, with one filter."""

_OPEN = replace(CONTOUR, depth=DepthOrderConfig(), height=HeightConfig(), occlusion=StayBehindConfig())

BASES: Mapping[str, TrackerConfig] = {
    **{name: VARIANTS[name] for name in SINGLE},
    "thesis-thermal": THESIS,
    "thesis-colour": THESIS_COLOUR,
    "thesis-occlusion": THESIS_OCCLUSION,
    "paper-several": PAPER,
    "contour": CONTOUR,
    "contour-thermal": replace(_OPEN, colour=None, appearance=None),
    "contour-colour": _OPEN,
    # The contour tracker with the thesis's colour model, which has several colour descriptors.
    "contour-moments": replace(_OPEN, colour=THESIS_COLOUR.colour, appearance=None),
}
"""Every tracker of the sources, and the contour tracker with the corresponding components."""


@dataclass(frozen=True, slots=True)
class TrackerSetting:
    """A base and changes of its settings.

    Attributes:
        base: one of `BASES`.
        changes: (path, value) such as ("person.count", 300).
    """

    base: str
    changes: Changes = ()

    @property
    def key(self) -> str:
        """Return the setting in one line."""
        return " ".join([self.base, *(f"{path}={value}" for path, value in self.changes)])

    def config(self) -> TrackerConfig:
        """Return the tracker's settings.

        Raises:
            BadInput: the base or a setting is unknown.
        """
        if self.base not in BASES:
            raise BadInput(f"unknown base {self.base!r}; choose from {', '.join(BASES)}")
        config = BASES[self.base]
        for path, value in self.changes:
            config = changed(config, path, value)
        return config

    def value(self, path: str) -> Any:
        """Return the setting at a path."""
        return attrgetter(path)(self.config())

    def make(self, rng: np.random.Generator) -> Tracker:
        """Create the tracker."""
        config = self.config()
        return SingleFilter(config, rng) if self.base in SINGLE else ContourTracker(config, rng)


def changes_of(values: Mapping[str, Any]) -> Changes:
    """Return settings with their values; lists become tuples."""
    return tuple((path, tuple(one) if isinstance(one, list) else one) for path, one in values.items())


def changed(record: Any, path: str, value: Value) -> Any:
    """Return nested records with the setting at a path, such as "person.count", changed.

    Raises:
        BadInput: the setting is unknown.
    """
    head, _, rest = path.partition(".")
    names = [field.name for field in fields(record)]
    if head not in names:
        raise BadInput(f"{type(record).__name__}: unknown setting {head!r}; choose from {', '.join(names)}")
    return replace(record, **{head: changed(getattr(record, head), rest, value) if rest else value})
