"""Declare the figures of a score once: key, table name, unit and meaning."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any, Final

Row = tuple[str, float, str, str]  # name, value, unit, explanation

# Records hold shares and radians.
_IN_UNIT: Final[Mapping[str, Callable[[float], float]]] = {
    "%": lambda share: 100.0 * share,
    "deg": math.degrees,
}


@dataclass(frozen=True, slots=True)
class Metric:
    """What one figure is called in tables, its unit there, and what it means."""

    name: str
    unit: str
    meaning: str

    @property
    def label(self) -> str:
        """Its name with its unit."""
        return f"{self.name}, {self.unit}" if self.unit else self.name


def metric(name: str, unit: str, meaning: str) -> Any:
    """Declare a figure as a field of a `ScoreRecord`."""
    return field(metadata={"metric": Metric(name, unit, meaning)})


class ScoreRecord:
    """A dataclass whose fields are all declared by `metric`; NaN is what is not defined."""

    __slots__ = ()

    @classmethod
    def metrics(cls) -> dict[str, Metric]:
        """Return the figures by their key in metrics.json."""
        return {one.name: one.metadata["metric"] for one in fields(cls)}  # type: ignore[arg-type]

    def rows(self) -> list[Row]:
        """Return the figures as table rows: name, value, unit, explanation."""
        return [
            (one.name, _IN_UNIT.get(one.unit, float)(getattr(self, key)), one.unit, one.meaning)
            for key, one in self.metrics().items()
        ]

    def to_json(self) -> dict[str, Any]:
        """Return the figures as JSON can hold them: None for what is undefined."""
        figures: dict[str, Any] = asdict(self)  # type: ignore[call-overload]
        return {
            key: None if isinstance(value, float) and math.isnan(value) else value
            for key, value in figures.items()
        }
