"""What a run of `peopleboy reproduce` came to, as a file small enough to be shipped."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.reproductions.catalogue import EXPERIMENTS
from peopleboy.studies.reproductions.experiment import (
    Effort,
    ExperimentOutcome,
    Jackknife,
    Line,
    Samples,
    Values,
)
from peopleboy.studies.reproductions.source_page import PageHead

FOLDER: Final = Path(__file__).parents[2] / "sources"
RUN: Final = "run.json"
_DIGITS: Final = 6  # significant ones of each figure
_OF_A_PART: Final = ("Recorded", "Machine", "Code")  # what is said of a part of a later run
_OF_A_RUN: Final = ("Time", "Results")  # which no longer hold once parts of another run are there


@dataclass(frozen=True, slots=True)
class SourceRun:
    """A run.

    Attributes:
        head: what was done, with what, and when.
        outcomes: of each table and figure; their pictures are names of files beside the page.
    """

    head: PageHead
    outcomes: tuple[ExperimentOutcome, ...]

    @classmethod
    def read(cls, folder: Path = FOLDER) -> SourceRun:
        """Read the run that is shipped."""
        data = json.loads((folder / RUN).read_text(encoding="utf-8"))
        return cls(
            PageHead(**data["head"]), tuple(_outcome(number, one) for number, one in data["parts"].items())
        )

    def without(self, others: Sequence[ExperimentOutcome]) -> SourceRun:
        """Leave out the tables and figures that others are of, and what is said of them."""
        theirs = {one.experiment.id for one in others}
        facts = {name: fact for name, fact in self.head.facts.items() if name not in theirs}
        kept = tuple(one for one in self.outcomes if one.experiment.id not in theirs)
        return SourceRun(replace(self.head, facts=facts), kept)

    def with_later(self, later: SourceRun) -> SourceRun:
        """Take in tables and figures of a later run, and say of each when and with what it was made.

        What the first run took as a whole is left out: each part says that for itself.
        """
        said = "; ".join(f"{name.lower()} {later.head.facts[name]}" for name in _OF_A_PART)
        kept = self.without(later.outcomes)
        facts = {
            **{name: fact for name, fact in kept.head.facts.items() if name not in _OF_A_RUN},
            **{one.experiment.id: f"of a later run: {said}" for one in later.outcomes},
        }
        places = list(EXPERIMENTS)
        every = sorted((*kept.outcomes, *later.outcomes), key=lambda one: places.index(one.experiment.id))
        return SourceRun(replace(self.head, facts=facts), tuple(every))

    def write(self, folder: Path = FOLDER) -> None:
        """Keep it."""
        parts = {one.experiment.id: _plain(one) for one in self.outcomes}
        lines = (f"  {json.dumps(number)}: {json.dumps(one)}" for number, one in parts.items())
        text = ",\n".join(lines)
        head = json.dumps(asdict(self.head), indent=1, ensure_ascii=False)
        (folder / RUN).write_text(f'{{"head": {head},\n "parts": {{\n{text}\n}}}}\n', encoding="utf-8")


def _plain(outcome: ExperimentOutcome) -> dict[str, Any]:
    return {
        "picture": outcome.picture,
        "left_out": outcome.left_out,
        "effort": None if outcome.effort is None else asdict(outcome.effort),
        "samples": [
            [
                line.group,
                line.method,
                {name: _plain_values(several) for name, several in values.items()},
            ]
            for line, values in outcome.samples.items()
        ],
    }


def _outcome(number: str, plain: Mapping[str, Any]) -> ExperimentOutcome:
    samples: Samples = {
        Line(group, method): {name: _values(several) for name, several in values.items()}
        for group, method, values in plain["samples"]
    }
    return ExperimentOutcome(
        EXPERIMENTS[number],
        samples,
        plain["picture"],
        tuple(plain["left_out"]),
        None if plain["effort"] is None else Effort(**plain["effort"]),
    )


def _plain_values(values: Values) -> list[float | None] | dict[str, Any]:
    if not isinstance(values, Jackknife):
        return _short(np.asarray(values))
    return {
        "films": values.suites,
        "whole": _short(np.array([values.whole]))[0],
        "without": _short(values.without),
    }


def _values(plain: list[float | None] | Mapping[str, Any]) -> Values:
    if isinstance(plain, list):
        return _long(plain)
    (whole,) = _long([plain["whole"]])
    return Jackknife(float(whole), _long(plain["without"]), tuple(plain["films"]))


def _short(values: NDArray[np.float64]) -> list[float | None]:
    """Cut figures to a few digits; None for NaN."""
    return [None if math.isnan(one) else float(f"{one:.{_DIGITS}g}") for one in values.tolist()]


def _long(values: list[float | None]) -> NDArray[np.float64]:
    return np.array([math.nan if one is None else one for one in values])
