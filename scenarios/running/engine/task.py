"""What the engine works through, and what becomes of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from peopleboy.bad_input import BadInput
from peopleboy.own_code import OwnCodeFailed, in_one_line

Result_co = TypeVar("Result_co", covariant=True)

Tell = Callable[[int], None]
"""Told how much of a task is done."""


class Task(Protocol[Result_co]):
    """A piece of work: a value that any process can do, and do again if the one that did it was killed."""

    @property
    def name(self) -> str:
        """What users know it by."""
        ...

    @property
    def size(self) -> int:
        """How far it moves a progress bar."""
        ...

    def __call__(self, tell: Tell) -> Result_co:
        """Do it; what an earlier attempt has finished on disk is not done again."""
        ...


@dataclass(frozen=True, slots=True)
class Failure:
    """A task that could not be done.

    Attributes:
        name: of the task.
        why: in one line.
        is_refused: whether it was bad input.
    """

    name: str
    why: str
    is_refused: bool = False


class TasksFailed(Exception):  # noqa: N818
    """Some tasks failed, and all others are done."""

    def __init__(self, title: str, failures: Sequence[Failure], total: int) -> None:
        count = (
            f"{len(failures)} of {total} failed; what is done stays, and the same command tries these again"
        )
        super().__init__("\n".join([f"{title}: {count}", *(f"  {one.name}: {one.why}" for one in failures)]))
        self.failures = tuple(failures)


def attempt(task: Task[Any], tell: Tell) -> Any:
    """Do a task, and give its result, or a `Failure` if an error ends it."""
    try:
        return task(tell)
    except BadInput as error:
        return Failure(task.name, str(error), is_refused=True)
    except OwnCodeFailed as error:
        return Failure(task.name, str(error))
    except Exception as error:
        return Failure(task.name, in_one_line(error))
