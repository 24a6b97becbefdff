"""Render findings as sentences: these tables have every sentence of a report about a run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

# Visibility of a person at a failure, as the rest of "Anna ...".
CAUSES: Final = {
    "left": "left the image",
    "away": "was out of the image for {duration}",
    "wholly": "was wholly hidden{by}",
    "partly": "was hidden to {share}{by}",
    "far": "was beyond {limit} m",
    "near": "was nearer than {limit} m",
    "cut off": "was cut off by the image border",
    "plain": "was in plain sight",
    "in front": "was in plain sight, in front of {other}",
    "no person": "there was no person",
}

# Outcome of a lost track.
AFTERWARDS: Final = {
    "never": "it never came back",
    "again": "shown again after {gap}{late}, {where}",
    "renumbered": "{person} was found {when} as number {number}{absence}",
    "hidden": "{person} was hidden until the end",
    "away": "{person} did not come back into view",
    "ended": "the run ended {rest} later",
    "lost": "{person} was not found again",
}

# Parts of a headline: for one finding in one run, for several in one run, and for several runs.
HEADLINES: Final = {
    "reached": (
        "The robot reached its goal after {time}",
        "The robot reached its goal after {time}",
        "the robot reached its goal in {runs}",
    ),
    "not reached": (
        "The robot did not reach its goal, but came within {distance} of it",
        "The robot did not reach its goal, but came within {distance} of it",
        "the robot did not reach its goal in {runs}",
    ),
    "never found": (
        "The robot never found {person}",
        "The robot never found {person}",
        "the robot never found its person in {runs}",
    ),
    "lost for good": (
        "The robot lost {person} for good at {time}",
        "The robot lost {person} for good at {time}",
        "the robot lost its person for good in {runs}",
    ),
    "followed": (
        "The robot reached {person} and followed to the end",
        "The robot reached {person} and followed to the end",
        "the robot reached its person and followed to the end in {runs}",
    ),
    "drove": (
        "The robot drove {distance} of corridor",
        "The robot drove {distance} of corridor",
        "the robots drove {distance} of corridor",
    ),
    "collided": (
        "the robot touched {names}, first at {time}",
        "the robot touched {names}, first at {time}",
        "{contacts} of the robot",
    ),
    "transfer": (
        "Number {number} passed from {person} to {other} at {time}, when {person} {cause}",
        "A number passed to another person {times}, first number {number} from {person} to {other} at {time}",
        "a number passed to another person {times}, in {runs}",
    ),
    "people": (
        "1 person, {how} the end{aside}",
        "{count} people, {which} tracked to the end{aside}",
        "of {people} {tracked} tracked to the end{hidden}",
    ),
    "no people": ("No person was due to be tracked",) * 3,
    "lost": (
        "identity lost once, at {time}, when {person} {cause}",
        "identity lost {times}, first at {time}, when {person} {cause}",
        "identity lost {times}, in {runs}",
    ),
    "none lost": ("no identity lost",) * 3,
    "reidentified": (
        "{person} was re-identified as number {new} after {duration} as number {old}",
        "{times} a person was re-identified, after at most {longest} under another number",
        "{times} a person was re-identified, after at most {longest} under another number",
    ),
    "false tracks": ("{tracks}",) * 3,
}

# Title and text of a failure.
MOMENTS: Final = {
    "transfer": (
        "Number {number} passes from {person} to {other}",
        "{person} {cause}; from then on {other} had number {number}.",
    ),
    "lost": ("{person} loses number {old}", "{person} {cause}, and then had number {new}."),
    "contact": ("Contact with {person}", "The robot touches {person}."),
    "false track": ("Number {number} is a false track", "It lasts {duration} and is never on a person."),
    "missed": ("{person} is not found", "{person} has no track for {duration}, with up to {share} visible."),
    "adrift": (
        "The box of {person} drifts away",
        "The box of {person} is not on the person for {duration}, with up to {share} visible.",
    ),
    "worst fit": (
        "Worst-fitting box of {person}",
        "The IoU of box and ground truth is {iou}; {share} of {person} is visible.",
    ),
}


@dataclass(frozen=True, slots=True)
class Cause:
    """Visibility of a person at a failure; `str` gives the rest of "Anna ...".

    Attributes:
        kind: one of `CAUSES`.
        values: values of its template.
        is_before: whether the cause ended just before, with the person in plain sight at the failure itself.
    """

    kind: str
    values: Mapping[str, str] = field(default_factory=dict)
    is_before: bool = False

    def __str__(self) -> str:
        text = CAUSES[self.kind].format(**self.values)
        before = text.replace("was ", "been ", 1)
        return f"{CAUSES['plain']}, but had just {before}" if self.is_before else text


@dataclass(frozen=True, slots=True)
class Finding:
    """One kind of finding, in one run or in several.

    Attributes:
        kind: one of `HEADLINES`.
        count: number of occurrences.
        values: values of its template.
    """

    kind: str
    count: int
    values: Mapping[str, object] = field(default_factory=dict)

    def sentence(self, *, is_of_many_runs: bool) -> str:
        """Return the finding as a part of a headline."""
        template = HEADLINES[self.kind][2 if is_of_many_runs else min(self.count, 2) - 1]
        return template.format(times=times(self.count), count=self.count, **self.values)


def spoken(name: str) -> str:
    """Return a key of a file as a name in a sentence: Anna, Floor lamp 1."""
    words = name.replace("_", " ")
    return words[:1].upper() + words[1:]


def listed(words: Sequence[str]) -> str:
    """Join words: a, b and c."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""


def times(count: int) -> str:
    """Return a number of times as text."""
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def seconds(time_s: float) -> str:
    """Format a time or a duration, with its unit on the same line."""
    return f"{time_s:.1f}\u00a0s"
