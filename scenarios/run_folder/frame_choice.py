"""Choose frames of runs for a data set: by interval, number per run, and the people who are visible.

`render` writes only the chosen frames of its runs, and `export` exports only the chosen frames of finished
runs. Both choose alike: every Nth frame is a candidate; the candidates of a run are divided into as many
equal parts as frames are wanted; and in each part the first suitable candidate is used, counted from a random
one.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Annotated, Any, Final, NamedTuple

from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.random_streams import stream
from peopleboy.settings import Metavar
from peopleboy.sim.truth.truth import PersonTruth


class VisiblePerson(NamedTuple):
    """What decides whether a visible person counts: height of the visible box [px], visible fraction."""

    height_px: float
    fraction: float


def visible_people(people: Iterable[PersonTruth]) -> list[VisiblePerson]:
    """Return the people with at least one visible pixel."""
    return [
        VisiblePerson(person.visible_box[3], person.visible_fraction)
        for person in people
        if person.visible_box is not None
    ]


VISIBLE_COLUMNS: Final = ("frame", "visible_height_px", "visible_fraction")
"""Columns of a table of ground truth from which `visible_rows` reads."""


def visible_rows(rows: Iterable[Mapping[str, Any]]) -> list[VisiblePerson]:
    """Return the people with at least one visible pixel from rows of a table of ground truth."""
    return [
        VisiblePerson(row["visible_height_px"], row["visible_fraction"])
        for row in rows
        if row["visible_height_px"] is not None
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameChoice:
    """Which frames of each run a data set contains; by default, all.

    A person counts if the visible part is high enough, and a large enough share of the person is visible. A
    frame is suitable if enough people count, and at least one, or if no person is visible and empty frames
    are kept.
    """

    every: Annotated[int, Field(ge=1, description="Use only every Nth frame of a run."), Metavar("N")] = 1
    frames_per_world: Annotated[
        int | None,
        Field(
            ge=1,
            description="Use at most N frames of each run, one from each Nth part of it.  [default: all]",
        ),
        Metavar("N"),
    ] = None
    keep_empty: Annotated[
        float,
        Field(ge=0.0, le=1.0, description="Share of the frames without visible people that are used."),
        Metavar("SHARE"),
    ] = 1.0
    least_people: Annotated[
        int,
        Field(
            ge=0,
            description="Minimum number of visible people in a frame; frames without people depend on "
            "--keep-empty.",
        ),
        Metavar("N"),
    ] = 0
    most_people: Annotated[
        int | None,
        Field(ge=1, description="Maximum number of visible people in a frame.  [default: any]"),
        Metavar("N"),
    ] = None
    least_height_px: Annotated[
        float,
        Field(ge=0.0, description="Minimum height of the visible part of people that count, in pixels."),
        Metavar("PX"),
    ] = 0.0
    least_visible: Annotated[
        float,
        Field(ge=0.0, le=1.0, description="Minimum visible fraction of people that count."),
        Metavar("SHARE"),
    ] = 0.0

    def __post_init__(self) -> None:
        """Refuse a minimum above the maximum.

        Raises:
            BadInput: it is.
        """
        if self.most_people is not None and self.most_people < self.least_people:
            raise BadInput(
                f"--most-people {self.most_people}: is below --least-people {self.least_people}; "
                "give a larger number"
            )

    @property
    def is_all(self) -> bool:
        """Whether every frame is chosen."""
        return self == FrameChoice()

    def to_json(self) -> dict[str, Any]:
        """Return the settings that differ from their defaults."""
        usual = asdict(FrameChoice())
        return {name: value for name, value in asdict(self).items() if value != usual[name]}

    def options(self) -> str:
        """Return the settings as options of a command."""
        return " ".join(f"--{key.replace('_', '-')} {value:g}" for key, value in self.to_json().items())

    def suits(self, people: Sequence[VisiblePerson], *, may_be_empty: bool) -> bool:
        """Return whether a frame with these visible people is suitable."""
        if not people:
            return may_be_empty
        counted = sum(
            one.height_px >= self.least_height_px and one.fraction >= self.least_visible for one in people
        )
        most = len(people) if self.most_people is None else self.most_people
        return max(1, self.least_people) <= counted <= most


class _Part(NamedTuple):
    """Candidates of which one is used, and whether it may be without people."""

    frames: frozenset[int]
    may_be_empty: bool


class FramePicker:
    """Choose frames of one run, which are offered in ascending order.

    Args:
        choice: which frames.
        frames: the frames of the run that exist, ascending.
        seed: seed of the run, from which the random candidates and the empty frames are sampled.
    """

    def __init__(self, choice: FrameChoice, frames: Sequence[int], seed: int) -> None:
        self._choice = choice
        rng = stream(seed, "frame_choice")
        candidates = frames[:: choice.every]
        count = min(choice.frames_per_world or len(candidates), len(candidates))
        self._parts: list[_Part] = []
        for k in range(count):
            part = candidates[len(candidates) * k // count : len(candidates) * (k + 1) // count]
            start, kept = int(rng.integers(len(part))), bool(rng.random() < choice.keep_empty)
            self._parts.append(_Part(frozenset(part[start:]), kept))

    @property
    def is_done(self) -> bool:
        """Whether no later frame can be chosen."""
        return not self._parts

    def wants(self, frame: int) -> bool:
        """Return whether a frame is chosen if the people in it are suitable; earlier frames are dropped."""
        while self._parts and frame > max(self._parts[0].frames):
            self._parts.pop(0)
        return bool(self._parts) and frame in self._parts[0].frames

    def takes(self, frame: int, people: Sequence[VisiblePerson]) -> bool:
        """Choose a frame if it is wanted and the people in it are suitable; return whether it is chosen."""
        if not self.wants(frame) or not self._choice.suits(people, may_be_empty=self._parts[0].may_be_empty):
            return False
        self._parts.pop(0)
        return True


def chosen_frames(
    choice: FrameChoice, frames: Sequence[int], people: Mapping[int, Sequence[VisiblePerson]], seed: int
) -> tuple[int, ...]:
    """Return the chosen frames of a finished run.

    Args:
        choice: which frames.
        frames: the frames that exist, ascending.
        people: visible people by frame; frames without any may be missing.
        seed: seed of the run.
    """
    picker = FramePicker(choice, frames, seed)
    return tuple(frame for frame in frames if picker.takes(frame, people.get(frame, ())))
