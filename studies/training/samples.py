"""Samples to train on: arrays in files, and the tasks that collect them, sequence by sequence."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, ClassVar, Self, TypeVar

import numpy as np

from peopleboy.scenarios.run_folder.atomic_output import atomic, writing_to
from peopleboy.scenarios.running.engine.task import Tell, Workers
from peopleboy.scenarios.running.engine.work_through import work_through


@dataclass(frozen=True, slots=True, eq=False)
class Arrays:
    """Base of samples and sequences, whose fields are arrays."""

    IS_COMPRESSED: ClassVar[bool] = True

    def save(self, path: Path) -> None:
        """Write the arrays, whole or not at all."""
        arrays: dict[str, Any] = {each.name: getattr(self, each.name) for each in fields(self)}
        with atomic(path) as part, part.open("wb") as file:
            (np.savez_compressed if self.IS_COMPRESSED else np.savez)(file, **arrays)

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read such arrays."""
        with np.load(path, allow_pickle=False) as arrays:
            return cls(**arrays)

    @classmethod
    def join(cls, parts: Sequence[Self]) -> Self:
        """Concatenate at least one part, array by array."""
        return cls(*(np.concatenate([getattr(one, each.name) for one in parts]) for each in fields(cls)))


AnyArrays = TypeVar("AnyArrays", bound=Arrays)


@dataclass(frozen=True, slots=True)
class SampleTask:
    """Collect the samples of one sequence, and leave them in a file.

    Attributes:
        path: of the file.
        collect: a function of a module, so that it can be sent to another process.
        arguments: of the function.
    """

    path: Path
    collect: Callable[..., Arrays]
    arguments: tuple[Any, ...]
    size: int = 1

    @property
    def name(self) -> str:
        """Which sequence."""
        return self.path.stem

    def __call__(self, tell: Tell) -> None:  # noqa: ARG002
        """Collect the samples and write them."""
        self.collect(*self.arguments).save(self.path)


def collect_missing(tasks: Iterable[SampleTask], workers: Workers, title: str) -> None:
    """Collect the samples of all tasks whose files are not there, so that a killed call resumes.

    Raises:
        BadInput: a path that cannot be used.
        TasksFailed: some tasks failed, after all others were done.
    """
    missing = [task for task in tasks if not task.path.is_file()]
    for folder in {task.path.parent for task in missing}:
        with writing_to(folder):
            folder.mkdir(parents=True, exist_ok=True)
    work_through(missing, workers, title)


def load_samples(kind: type[AnyArrays], tasks: Iterable[SampleTask]) -> AnyArrays:
    """Read the samples of tasks that are done."""
    return kind.join([kind.load(task.path) for task in tasks])
