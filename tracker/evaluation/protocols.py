"""Evaluation protocols: which people a benchmark scores, and which boxes of a tracker it leaves out.

The protocols of benchmarks give TrackEval's numbers. Our own protocol, `peopleboy`, is for rendered runs:
people who are too near, too far or fully occluded are neither missed nor, if tracked, false positives.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.sequence import Bools, TrueBoxes, find_fault

FLAG, CLASS, VISIBLE = 6, 7, 8
"""Columns of annotations (N, 9): frame, id, left, top, width, height, flag, class, visible fraction."""
CLASSES: Final = range(1, 14)
"""Classes of MOTChallenge."""
PERSON: Final = 1
DISTRACTOR: Final = 8
CROWD: Final = 13
_DISTRACTORS: Final = (2, 7, 8, 12)  # person on vehicle, static person, distractor, reflection
VEHICLE: Final = 6  # without a motor: a distractor in MOT20 only
MORE_THAN_HALF: Final = 0.5
_HALF: Final = float(np.nextafter(0.5 - np.finfo(np.float64).eps, 0.0))  # TrackEval's tolerance
_LEAST_HEIGHT_PX: Final = 25.0  # KITTI: lower boxes that match nothing are left out


class Protocol(StrEnum):
    """Name of a protocol."""

    PEOPLEBOY = "peopleboy"
    MOT15 = "mot15"
    MOT16 = "mot16"
    MOT17 = "mot17"
    MOT20 = "mot20"
    DANCETRACK = "dancetrack"
    KITTI = "kitti"
    VISDRONE = "visdrone"


@dataclass(frozen=True, slots=True)
class Rules:
    """The rules of a protocol.

    Attributes:
        has_classes: whether the file distinguishes other classes than people.
        ignored: classes of which a matched candidate is left out.
        regions: classes that mark regions, in which candidates that match nothing are left out.
        is_flag_ignored: whether a candidate that matches a row of flag 0 is left out; otherwise it stays.
        has_objects: whether rows of no interest are matched as well, so that they can take a candidate.
        least_height_px: candidates up to this height that match nothing are left out.
        min_visible: people with at most this visible fraction are ignored; None to score all.
        gate: IoU above which a candidate matches a person who is ignored.
    """

    has_classes: bool = True
    ignored: tuple[int, ...] = _DISTRACTORS
    regions: tuple[int, ...] = ()
    is_flag_ignored: bool = False
    has_objects: bool = True
    least_height_px: float = 0.0
    min_visible: float | None = None
    gate: float = _HALF


_MOT17: Final = Rules()
RULES: Final = {
    Protocol.PEOPLEBOY: Rules(is_flag_ignored=True, has_objects=False, min_visible=0.0, gate=MORE_THAN_HALF),
    Protocol.MOT15: Rules(has_classes=False, ignored=(), has_objects=False),
    Protocol.MOT16: _MOT17,
    Protocol.MOT17: _MOT17,
    Protocol.MOT20: Rules(ignored=(*_DISTRACTORS, VEHICLE)),
    Protocol.DANCETRACK: _MOT17,
    Protocol.KITTI: Rules(regions=(CROWD,), has_objects=False, least_height_px=_LEAST_HEIGHT_PX),
    Protocol.VISDRONE: Rules(regions=(CROWD,), is_flag_ignored=True),
}


def no_people() -> TrueBoxes:
    """Return ground truth without a box."""
    return TrueBoxes.from_rows([])


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """What is annotated besides people.

    Attributes:
        objects: boxes that are matched like people. A candidate on one is a false positive.
        regions: boxes in which candidates that match nothing are left out.
        least_height_px: candidates up to this height that match nothing are left out.
        gate: IoU above which a candidate matches a person or an object.
    """

    objects: TrueBoxes = field(default_factory=no_people)
    regions: TrueBoxes = field(default_factory=no_people)
    least_height_px: float = 0.0
    gate: float = MORE_THAN_HALF


EMPTY: Final = Surroundings()


def apply_protocol(path: Path, table: Floats, rules: Rules) -> tuple[TrueBoxes, Surroundings]:
    """Sort the rows (N, 9) of a file: people with those that are ignored, and what surrounds them.

    Raises:
        BadInput: a row is impossible (the message names its line).
    """
    kind, has_flag = table[:, CLASS], table[:, FLAG] != 0.0
    _check_classes(path, kind)
    is_person = kind == PERSON if rules.has_classes else np.ones(len(table), dtype=np.bool_)
    is_region = np.isin(kind, rules.regions)
    is_ignored = np.isin(kind, rules.ignored) | (is_person & ~has_flag & rules.is_flag_ignored)
    counted = is_person & has_flag
    is_object = ~(counted | is_ignored | is_region)
    flagged = np.where(is_ignored, 0.0, table[:, FLAG])
    check_rows(path, table)
    truth = _true_boxes(table, counted | is_ignored, flagged)
    ones = np.ones(len(table))
    objects = _true_boxes(table, is_object & rules.has_objects, ones)
    return truth, _around(rules, objects, _true_boxes(table, is_region, ones))


def recount(truth: TrueBoxes, protocol: Protocol) -> tuple[TrueBoxes, Surroundings]:
    """Score the people of a rendered run by a protocol, which may treat those who do not count as objects."""
    rules = RULES[protocol]
    if rules.is_flag_ignored:
        return truth, _around(rules, no_people(), no_people())
    others = truth.take(~truth.counted) if rules.has_objects else no_people()
    return truth.take(truth.counted), _around(rules, others, no_people())


def _around(rules: Rules, objects: TrueBoxes, regions: TrueBoxes) -> Surroundings:
    return Surroundings(objects, regions, rules.least_height_px, rules.gate)


def check_rows(path: Path, table: Floats) -> None:
    """Check the rows (N, 9) of a truth file.

    Raises:
        BadInput: a row is impossible (the message names its line).
    """
    columns = {"frame": table[:, 0], "id": table[:, 1], "box": table[:, 2:6]}
    fault = find_fault(columns | {"counted": table[:, FLAG], "visible": table[:, VISIBLE]})
    if fault is not None:
        raise BadInput(f"{path}:{fault[0] + 1}: {fault[1]}")


def _check_classes(path: Path, kind: Floats) -> None:
    for row in np.flatnonzero(~np.isin(kind, CLASSES))[:1]:
        raise BadInput(f"{path}:{row + 1}: class must be 1 (person) to 13, got {kind[row]:g}")


def _true_boxes(table: Floats, rows: Bools, counted: Floats) -> TrueBoxes:
    chosen = table[rows]
    return TrueBoxes(
        frame=chosen[:, 0].astype(np.int64),
        id=chosen[:, 1].astype(np.int64),
        box=chosen[:, 2:6],
        counted=counted[rows] != 0.0,
        visible=chosen[:, VISIBLE],
    )


# The protocol of a file, from the names of its folders, or from a sequence's name.

_NAMED: Final = (
    *((re.compile(rf"mot[-_ ]?(20)?{year}(?!\d)", re.IGNORECASE), f"mot{year}") for year in (15, 16, 17, 20)),
    (re.compile("dance_?track", re.IGNORECASE), "dancetrack"),
    (re.compile("visdrone", re.IGNORECASE), "visdrone"),
)


def named_protocol(names: Sequence[str]) -> Protocol | None:
    """Return the protocol that the last of some names mentions; None if none does."""
    for name in reversed(names):
        for pattern, protocol in _NAMED:
            if pattern.search(name):
                return Protocol(protocol)
    return None
