"""The learned classifier as a readable file."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from peopleboy.bad_input import BadInput
from peopleboy.tracker.reproductions.contour.occlusion.pair_features import FEATURES
from peopleboy.user_files import read_text

TABLES = Path(__file__).parent / "tables"
"""Folder of the shipped tables: NAME.yaml for the tracker of that name."""

_HEADER = """\
# Boosted classifier of which of two overlapping people, A or B, is in front (thesis, algorithm 5).
# A weak classifier votes for A if parity * sum < parity * threshold, where the sum adds up
# weight * feature / scale, and a feature is A's value minus B's. Votes are weighted by importance.
"""

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Name = Literal["strength", "top", "bottom", "colour", "colour_o", "colour_no"]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class _Weak(_Strict):
    weights: Annotated[dict[Name, Finite], Field(min_length=1)]
    threshold: Finite
    parity: Literal[1, -1]
    importance: Positive


class _Table(_Strict):
    about: dict[str, str] = {}
    scale: Annotated[dict[Name, Positive], Field(min_length=len(FEATURES))]
    classifiers: Annotated[list[_Weak], Field(min_length=1)]


@dataclass(frozen=True, slots=True, kw_only=True)
class WeakClassifier:
    """One vote, by a weighted sum of scaled features.

    Attributes:
        weights: by name of the feature.
        threshold: theta.
        parity: 1 votes for "in front" below the threshold, -1 above.
        importance: alpha, weight of the vote.
    """

    weights: dict[str, float]
    threshold: float
    parity: int
    importance: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnedTable:
    """All votes, best first, with a description.

    Attributes:
        scale: spread of each feature over the examples, by which it is divided.
        classifiers: the weak classifiers in the order of selection.
        about: description of the training data, for readers of the file.
    """

    scale: dict[str, float]
    classifiers: tuple[WeakClassifier, ...]
    about: dict[str, str] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write the table as YAML."""
        about = yaml.safe_dump({"about": self.about}, sort_keys=False, width=110)
        data = {
            "scale": {name: round(value, 6) for name, value in self.scale.items()},
            "classifiers": [
                {
                    "weights": {name: round(w, 4) for name, w in weak.weights.items()},
                    "threshold": round(weak.threshold, 5),
                    "parity": weak.parity,
                    "importance": round(weak.importance, 5),
                }
                for weak in self.classifiers
            ],
        }
        text = yaml.safe_dump(data, sort_keys=False, default_flow_style=None, width=110)
        path.write_text(_HEADER + about + text, encoding="utf-8")

    @classmethod
    def load(cls, path: Path) -> "LearnedTable":
        """Read and validate a table.

        Raises:
            BadInput: the file is missing or is not such a table.
        """
        try:
            data = yaml.safe_load(read_text(path))
        except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
            raise BadInput(f"{path}: cannot be read: {' '.join(str(error).split())}") from None
        try:
            table = _Table.model_validate(data)
        except ValidationError as error:
            first = error.errors()[0]
            place = ".".join(str(key) for key in first["loc"]) or "the file"
            raise BadInput(f"{path}: {place}: {first['msg']}, got {first['input']!r}") from None
        return cls(
            scale={name: table.scale[name] for name in FEATURES},  # type: ignore[index]
            classifiers=tuple(
                WeakClassifier(
                    weights={str(name): w for name, w in weak.weights.items()},
                    threshold=weak.threshold,
                    parity=weak.parity,
                    importance=weak.importance,
                )
                for weak in table.classifiers
            ),
            about=table.about,
        )
