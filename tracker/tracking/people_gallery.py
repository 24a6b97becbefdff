"""Gallery of people: what re-identification knows of each person, across runs, and its JSON file."""

import json
import math
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.sequence import LARGEST
from peopleboy.tracker.tracking.appearance import FEATURES, Colours
from peopleboy.tracker.tracking.reidentification import Candidates
from peopleboy.user_files import read_json

_FORMAT: Final = "peopleboy gallery"
_VERSION: Final = 1
_ANYWHERE_M2: Final = 1e6
"""Variance of the place of a person from an earlier run: larger than any room, so the place says nothing."""


class KnownPerson(NamedTuple):
    """A person of the gallery.

    Attributes:
        colours: (512,) colours of the clothes.
        build: logarithm of the stature divided by the usual stature.
        build_variance: variance of it.
    """

    colours: Colours
    build: float
    build_variance: float


@dataclass(slots=True)
class PeopleGallery:
    """People by id, and the next id.

    Attributes:
        people: by id.
        next_id: id of the next new person; larger than all ids so far, also of people who are not kept.
    """

    people: dict[int, KnownPerson] = field(default_factory=dict)
    next_id: int = 1

    def take_id(self) -> int:
        """Return the id of a new person."""
        self.next_id += 1
        return self.next_id - 1

    def absent(self, present: Collection[int]) -> list[int]:
        """Return the ids of all people but the present ones."""
        return [number for number in self.people if number not in present]

    def candidates(self, ids: Collection[int]) -> Candidates:
        """Return people (L) whose places are unknown."""
        known = [self.people[number] for number in ids]
        count = len(known)
        return Candidates(
            np.zeros((count, 2)),
            np.zeros((count, 2)),
            np.broadcast_to(_ANYWHERE_M2 * np.eye(2), (count, 2, 2)),
            np.array([(one.build, one.build_variance) for one in known]).reshape(count, 2),
            np.array([one.colours for one in known], np.float32).reshape(count, FEATURES),
        )

    def to_text(self) -> str:
        """Return the content of the file; equal galleries have equal files."""
        people = [
            {
                "id": number,
                "colours": one.colours.tolist(),
                "build": one.build,
                "build_variance": one.build_variance,
            }
            for number, one in sorted(self.people.items())
        ]
        content = {"format": _FORMAT, "version": _VERSION, "next_id": self.next_id, "people": people}
        return json.dumps(content) + "\n"


def read_gallery(path: Path) -> PeopleGallery:
    """Read a gallery.

    Raises:
        BadInput: the file cannot be read, or is not a gallery of this version.
    """
    try:
        content = read_json(path)
    except BadInput:
        raise
    except OSError as error:
        raise BadInput(f"cannot be read: {error.strerror or error}", file=str(path)) from None
    except ValueError:
        content = None
    if not isinstance(content, dict) or content.get("format") != _FORMAT:
        raise BadInput("is not a gallery of people; give another --gallery", file=str(path))
    if content.get("version") != _VERSION:
        raise BadInput(
            f"is a gallery of format version {content.get('version')!r}, and this PeopleBoy reads version "
            f"{_VERSION}; give another --gallery",
            file=str(path),
        )
    try:
        return _parse(content)
    except (KeyError, TypeError, ValueError, OverflowError):
        raise BadInput("is a damaged gallery; delete it, or give another --gallery", file=str(path)) from None


def _parse(content: dict[str, Any]) -> PeopleGallery:
    """Return the gallery of a file's content.

    Raises:
        KeyError, TypeError, ValueError, OverflowError: the content is invalid.
    """
    people = {_id(one["id"]): _parse_person(one) for one in content["people"]}
    next_id = _id(content["next_id"])
    if len(people) != len(content["people"]) or next_id <= max(people, default=0):
        raise ValueError("ids must be unique, and smaller than the next one")
    return PeopleGallery(people, next_id)


def _parse_person(one: dict[str, Any]) -> KnownPerson:
    colours = np.array(one["colours"], np.float32)
    build, variance = float(one["build"]), float(one["build_variance"])
    if colours.shape != (FEATURES,) or not ((colours >= 0.0) & (colours <= 1.0)).all() or not colours.any():
        raise ValueError("colours must be shares")
    if not (math.isfinite(build) and math.isfinite(variance) and variance >= 0.0):
        raise ValueError("the stature must be finite")
    return KnownPerson(colours, build, variance)


def _id(value: object) -> int:
    if type(value) is not int or not 1 <= value <= LARGEST:
        raise ValueError("not an id")
    return value
