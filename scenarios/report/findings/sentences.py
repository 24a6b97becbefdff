"""Render findings as sentences: every sentence of a report about a run stands in one of these tables."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

# What could be seen of a person when something went wrong, as the rest of "Anna ...".
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

# What came of a lost track.
AFTERWARDS: Final = {
    "never": "it never came back",
    "again": "shown again after {gap}{late}, {where}",
    "renumbered": "{person} was found {when} as number {number}{absence}",
    "hidden": "{person} was hidden until the end",
    "away": "{person} did not come back into view",
    "ended": "the run ended {rest} later",
    "lost": "{person} was not found again",
}

# The parts of a headline: of one thing in one run, of several in one run, and of those in several runs.
HEADLINES: Final = {
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
    "no people": ("No person was there to be found",) * 3,
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
    "contacts": (
        "the robot touched {names}, first at {time}",
        "the robot touched {names}, first at {time}",
        "{contacts} of the robot",
    ),
}

# Title and text of a moment at which something went wrong.
MOMENTS: Final = {
    "transfer": (
        "Number {number} passes from {person} to {other}",
        "{person} {cause}; from then on {other} was number {number}.",
    ),
    "lost": ("{person} loses number {old}", "{person} {cause}, and was then number {new}."),
    "contact": ("Contact with {person}", "The robot touches {person}."),
    "false track": ("Number {number} is a false track", "It lasts {duration} and never lies on a person."),
    "missed": ("{person} is not found", "{person} has no track for {duration} while up to {share} visible."),
    "adrift": (
        "{person} is left by the box",
        "{person} has a track whose box lies elsewhere for {duration} while up to {share} visible.",
    ),
    "worst fit": (
        "The box that fits {person} worst",
        "Box and truth overlap by {iou}; {share} of {person} is visible.",
    ),
}


@dataclass(frozen=True, slots=True)
class Cause:
    """What could be seen of a person when something went wrong; `str` gives the rest of "Anna ...".

    Attributes:
        kind: one of `CAUSES`.
        values: for its template.
        is_before: whether that was just before, and the person in plain sight at the moment itself.
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
    """One kind of thing that was found, in one run or in several.

    Attributes:
        kind: one of `HEADLINES`.
        count: how often.
        values: for its template.
    """

    kind: str
    count: int
    values: Mapping[str, object] = field(default_factory=dict)

    def sentence(self, *, is_of_many_runs: bool) -> str:
        """Render it as a part of a headline."""
        template = HEADLINES[self.kind][2 if is_of_many_runs else min(self.count, 2) - 1]
        return template.format(times=times(self.count), count=self.count, **self.values)


def spoken(name: str) -> str:
    """Write a key of a file as a name in a sentence: Anna, Floor lamp 1."""
    words = name.replace("_", " ")
    return words[:1].upper() + words[1:]


def listed(words: Sequence[str]) -> str:
    """Join words: a, b and c."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""


def times(count: int) -> str:
    """Return how often."""
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def seconds(time_s: float) -> str:
    """Write a time or a duration so that its unit stays on the line."""
    return f"{time_s:.1f}\u00a0s"
