"""Tasks, their results, and the workers that execute them."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, Protocol, TypeVar

from peopleboy.bad_input import BadInput
from peopleboy.own_code import OwnCodeFailed, in_one_line

Result_co = TypeVar("Result_co", covariant=True)

ReportProgress = Callable[[int], None]
"""Receives the number of finished units of a task."""


class Task(Protocol[Result_co]):
    """A piece of work that any process can execute, and repeat if the process that executed it was killed."""

    @property
    def name(self) -> str:
        """Name shown to users."""
        ...

    @property
    def size(self) -> int:
        """Number of units by which it moves a progress bar."""
        ...

    def __call__(self, report_progress: ReportProgress) -> Result_co:
        """Execute the task; parts that an earlier attempt left on disk are not repeated."""
        ...


@dataclass(frozen=True, slots=True)
class Failure:
    """A task that failed.

    Attributes:
        name: name of the task.
        why: reason on one line.
        is_refused: whether the cause was bad input.
    """

    name: str
    why: str
    is_refused: bool = False


class TasksFailed(Exception):  # noqa: N818
    """Some tasks failed, and all others are complete."""

    def __init__(self, title: str, failures: Sequence[Failure], total: int) -> None:
        count = f"{len(failures)} of {total} failed; the others are complete; run the command again to retry"
        super().__init__("\n".join([f"{title}: {count}", *(f"  {one.name}: {one.why}" for one in failures)]))
        self.failures = tuple(failures)


def attempt(task: Task[Any], report_progress: ReportProgress) -> Any:
    """Execute a task, and return its result, or a `Failure` if it raises an error."""
    try:
        return task(report_progress)
    except BadInput as error:
        return Failure(task.name, str(error), is_refused=True)
    except OwnCodeFailed as error:
        return Failure(task.name, str(error))
    except Exception as error:
        # A signal that arrives within a kernel of numba becomes the cause of a SystemError.
        if isinstance(error.__cause__, SystemExit | KeyboardInterrupt):
            raise error.__cause__ from None
        return Failure(task.name, in_one_line(error))


@dataclass(frozen=True, slots=True)
class Workers:
    """Workers that execute tasks.

    Attributes:
        count: number of local processes; with one, tasks run in the calling process; None for one per core.
        scheduler: address of a Dask scheduler whose workers are used instead; None for this machine.
    """

    count: int | None = 1
    scheduler: str | None = None


def chosen_workers(count: int | None, scheduler: str | None) -> Workers:
    """Return the workers that the user asked for; by default, one process per core.

    Raises:
        BadInput: both count and scheduler are given.
    """
    if scheduler is not None and count is not None:
        raise BadInput(f"--workers {count}: not with --scheduler, whose cluster has its own; leave one out")
    return Workers(count, scheduler)


Source = dict[str, str]


@cache
def running_source() -> Source:
    """Return package versions by name, and under "source" a hash of PeopleBoy's own files.

    Workers of a cluster must have the same, because the output depends on them.
    """
    from peopleboy.scenarios.run_folder.folder import versions  # here, as the command line imports us

    digest = sha256()
    root = Path(__file__).parents[3]
    for folder, inner, names in os.walk(root, followlinks=True):
        inner.sort()
        for name in sorted(names):
            if name.endswith((".py", ".yaml", ".urdf")):
                path = Path(folder, name)
                digest.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes())
    return versions() | {"source": digest.hexdigest()}
