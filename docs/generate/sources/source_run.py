"""Results of a run of `peopleboy reproduce`, in a file that is small enough to be shipped."""

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
from peopleboy.studies.reproductions.image_errors import ErrorSummary, ImageErrors
from peopleboy.studies.reproductions.source_page import PageHead

FOLDER: Final = Path(__file__).parents[2] / "sources"
RUN: Final = "run.json"
_DIGITS: Final = 6  # significant digits of each value
_OF_A_PART: Final = ("Recorded", "Machine", "Code")  # facts that are given for a part of a later run
_OF_A_RUN: Final = ("Time", "Results")  # facts that are not valid with parts of another run


@dataclass(frozen=True, slots=True)
class SourceRun:
    """Results of a run.

    Attributes:
        head: facts about the run: what was done, with what, and when.
        outcomes: outcomes of each table and figure; their pictures are names of files next to the page.
    """

    head: PageHead
    outcomes: tuple[ExperimentOutcome, ...]

    @classmethod
    def read(cls, folder: Path = FOLDER) -> SourceRun:
        """Read the shipped run."""
        data = json.loads((folder / RUN).read_text(encoding="utf-8"))
        return cls(
            PageHead(**data["head"]), tuple(_outcome(number, one) for number, one in data["parts"].items())
        )

    def without(self, others: Sequence[ExperimentOutcome]) -> SourceRun:
        """Return the run without the tables and figures of others, and without the facts about them."""
        theirs = {one.experiment.id for one in others}
        facts = {name: fact for name, fact in self.head.facts.items() if name not in theirs}
        kept = tuple(one for one in self.outcomes if one.experiment.id not in theirs)
        return SourceRun(replace(self.head, facts=facts), kept)

    def with_later(self, later: SourceRun) -> SourceRun:
        """Return the run with tables and figures of a later run, and with the facts about each.

        The total time of the first run is left out, since each part has its own.
        """
        said = "; ".join(f"{name.lower()} {later.head.facts[name]}" for name in _OF_A_PART)
        kept = self.without(later.outcomes)
        facts = {
            **{name: fact for name, fact in kept.head.facts.items() if name not in _OF_A_RUN},
            **{one.experiment.id: f"from a later run: {said}" for one in later.outcomes},
        }
        places = list(EXPERIMENTS)
        every = sorted((*kept.outcomes, *later.outcomes), key=lambda one: places.index(one.experiment.id))
        return SourceRun(replace(self.head, facts=facts, command=later.head.command), tuple(every))

    def write(self, folder: Path = FOLDER) -> None:
        """Write the run to a file."""
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
    if isinstance(values, ImageErrors):
        summaries = {"splits": values.splits, "blocks": values.blocks}
        return {name: [_plain_summary(one) for one in several] for name, several in summaries.items()} | {
            "of_films": values.films
        }
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
    if "splits" in plain:
        splits, blocks = (tuple(ErrorSummary(*one) for one in plain[name]) for name in ("splits", "blocks"))
        return ImageErrors(splits=splits, blocks=blocks, films=plain["of_films"])
    (whole,) = _long([plain["whole"]])
    return Jackknife(float(whole), _long(plain["without"]), tuple(plain["films"]))


def _plain_summary(one: ErrorSummary) -> list[Any]:
    return [one.images, *_short(np.array(one[1:]))]


def _short(values: NDArray[np.float64]) -> list[float | None]:
    """Round values to a few digits; None for NaN."""
    return [None if math.isnan(one) else float(f"{one:.{_DIGITS}g}") for one in values.tolist()]


def _long(values: list[float | None]) -> NDArray[np.float64]:
    return np.array([math.nan if one is None else one for one in values])
