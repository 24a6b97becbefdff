"""Tasks, their outcome, and the workers that run them."""

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

Tell = Callable[[int], None]
"""Receives how much of a task is done."""


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


@dataclass(frozen=True, slots=True)
class Workers:
    """Who does the work.

    Attributes:
        count: processes of this machine; with one, everything is done in the process that asks for it.
        scheduler: address of a Dask scheduler whose workers do it instead; None for this machine.
    """

    count: int = 1
    scheduler: str | None = None


def chosen_workers(count: int | None, scheduler: str | None) -> Workers:
    """Take what the user gave; without it, one process a core.

    Raises:
        BadInput: both are given.
    """
    if scheduler is not None and count is not None:
        raise BadInput(f"--workers {count}: the cluster of --scheduler has workers of its own; leave one out")
    from joblib import cpu_count  # here, as loading it takes half as long as all of `peopleboy --help`

    return Workers(cpu_count() if count is None else count, scheduler)


Source = dict[str, str]


@cache
def running_source() -> Source:
    """Return the versions of packages by name, and under "source" a hash of PeopleBoy's own files.

    Workers of a cluster must have the same, since bytes depend on them.
    """
    from peopleboy.scenarios.run_folder.folder import versions  # here, as the command line loads this module

    digest = sha256()
    root = Path(__file__).parents[3]
    for folder, inner, names in os.walk(root, followlinks=True):
        inner.sort()
        for name in sorted(names):
            if name.endswith((".py", ".yaml", ".urdf")):
                path = Path(folder, name)
                digest.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes())
    return versions() | {"source": digest.hexdigest()}
