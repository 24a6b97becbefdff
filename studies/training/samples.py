"""Training samples: arrays in files, and the tasks that collect them, one per sequence."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, ClassVar, Generic, NamedTuple, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.run_folder.atomic_output import atomic, writing_to
from peopleboy.scenarios.running.engine.store import code_digest
from peopleboy.scenarios.running.engine.task import ReportProgress, Workers
from peopleboy.scenarios.running.engine.work_through import work_through


@dataclass(frozen=True, slots=True, eq=False)
class Arrays:
    """Base of samples and sequences, whose fields are arrays."""

    IS_COMPRESSED: ClassVar[bool] = True

    def __len__(self) -> int:
        return len(getattr(self, fields(self)[0].name))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays by name."""
        return {each.name: getattr(self, each.name) for each in fields(self)}

    def save(self, path: Path) -> None:
        """Write the arrays atomically."""
        write: Callable[..., None] = np.savez_compressed if self.IS_COMPRESSED else np.savez
        with atomic(path) as part, part.open("wb") as file:
            write(file, **self.arrays())

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read arrays from a file."""
        with np.load(path, allow_pickle=False) as arrays:
            return cls(**arrays)

    @classmethod
    def join(cls, parts: Sequence[Self]) -> Self:
        """Concatenate one or more parts, array by array."""
        return cls(
            **{each.name: np.concatenate([getattr(one, each.name) for one in parts]) for each in fields(cls)}
        )

    def take(self, rows: NDArray[Any]) -> Self:
        """Select rows of all arrays, by index or by mask; all arrays must have the same length."""
        return type(self)(**{name: array[rows] for name, array in self.arrays().items()})

    def to_plain(self) -> dict[str, Any]:
        """Return the arrays as plain data."""
        return {name: [one.dtype.str, one.shape, one.ravel().tolist()] for name, one in self.arrays().items()}

    @classmethod
    def from_plain(cls, plain: Mapping[str, Any]) -> Self:
        """Restore the arrays from plain data exactly."""
        return cls(**{name: np.array(one, kind).reshape(shape) for name, (kind, shape, one) in plain.items()})


AnyArrays = TypeVar("AnyArrays", bound=Arrays)
Part = TypeVar("Part")


class Split(NamedTuple, Generic[Part]):
    """Training and validation split."""

    training: Part
    validation: Part


@dataclass(frozen=True, slots=True)
class SampleTask:
    """Collect the samples of one sequence, and write them to a file.

    Attributes:
        path: path of the file.
        collect: a module-level function, so that it can be pickled for another process.
        arguments: its arguments.
    """

    path: Path
    collect: Callable[..., Arrays]
    arguments: tuple[Any, ...]
    size: int = 1

    @property
    def name(self) -> str:
        """Name of the sequence."""
        return self.path.stem

    def __call__(self, report_progress: ReportProgress) -> None:  # noqa: ARG002
        """Collect the samples and write them."""
        self.collect(*self.arguments).save(self.path)


Tasks = Split[list[SampleTask]]


def sample_folder(out: Path, *further: Path) -> Path:
    """Return a folder for samples that depends on the current code, and on the content of other files."""
    return out / f"samples-{code_digest(*further)}"


def collect_missing(tasks: Tasks, workers: Workers) -> None:
    """Collect the samples of all tasks whose files are missing, so that an interrupted run resumes.

    Raises:
        BadInput: a path that cannot be used.
        TasksFailed: some tasks failed, after all others were done.
    """
    missing = [task for task in (*tasks.validation, *tasks.training) if not task.path.is_file()]
    folders = {task.path.parent for task in missing}
    for folder in folders:
        with writing_to(folder):
            folder.mkdir(parents=True, exist_ok=True)
    try:
        work_through(missing, workers, "samples")
    finally:
        for folder in folders:
            with suppress(OSError):
                folder.rmdir()  # fails unless the folder is empty


def load_samples(kind: type[AnyArrays], tasks: Sequence[SampleTask]) -> AnyArrays:
    """Read the samples of completed tasks."""
    return kind.join([kind.load(task.path) for task in tasks])
