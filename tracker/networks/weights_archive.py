"""The archive in which all learned weights are kept: named arrays, what they were trained on, and the camera.

It is NumPy's `.npz` without pickles. The same content always gives the same bytes.
"""

from __future__ import annotations

import json
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from peopleboy.bad_input import BadInput

SHIPPED: Final = Path(__file__).parent / "weights"
"""Folder of the weights that come with the trackers."""

_ABOUT: Final = "about"
_CAMERA: Final = "camera"
# An encrypted member, or one that is compressed in an unknown way, makes zipfile raise RuntimeError.
_UNREADABLE: Final = (
    ValueError, KeyError, TypeError, AttributeError, EOFError, RuntimeError, SyntaxError, zipfile.BadZipFile,
    zlib.error,
)  # fmt: skip


@contextmanager
def open_archive(path: Path, command: str) -> Iterator[Mapping[str, Any]]:
    """Open a NumPy archive, which a command makes, for what is read within.

    Raises:
        BadInput: a file that is missing, is none, or lacks what is read.
    """
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            yield archive
    except OSError as error:
        why = error.strerror or str(error)
        raise BadInput(f"cannot be read: {why}; `{command}` makes one", file=str(path)) from None
    except _UNREADABLE:
        raise BadInput(f"is no file of weights; `{command}` makes one", file=str(path)) from None


class ArraySpec(NamedTuple):
    """What an array of an archive must be.

    Attributes:
        shape: sizes; a name stands for any size of at least 1, the same wherever the name occurs.
        dtype: of its numbers.
        may_be_infinite: whether numbers may be infinite; NaN is never allowed.
    """

    shape: tuple[int | str, ...]
    dtype: DTypeLike = np.float32
    may_be_infinite: bool = False

    def __str__(self) -> str:
        kind = np.dtype(self.dtype)
        finite = "finite " * (kind.kind == "f" and not self.may_be_infinite)
        shape = ", ".join(map(str, self.shape)) + "," * (len(self.shape) == 1)
        return f"{finite}{kind} ({shape})"

    def is_met(self, array: NDArray[Any], sizes: dict[str, int]) -> bool:
        """Check an array against known sizes, and add its sizes."""
        if array.dtype != self.dtype or array.ndim != len(self.shape):
            return False
        expected = [sizes.setdefault(n, max(found, 1)) if isinstance(n, str) else n
                    for n, found in zip(self.shape, array.shape, strict=True)]  # fmt: skip
        is_valid = ~np.isnan(array) if self.may_be_infinite else np.isfinite(array)
        return list(array.shape) == expected and bool(is_valid.all())


@dataclass(frozen=True, slots=True, eq=False)
class WeightsArchive:
    """The content of a file of weights.

    Attributes:
        arrays: by name.
        about: what they were trained on and how well they do, for the reader.
        camera: the camera that they hold for; None for any.
    """

    arrays: Mapping[str, NDArray[Any]]
    about: Mapping[str, str] = field(default_factory=dict)
    camera: Any = None

    def save(self, path: Path) -> None:
        """Write the archive; a camera is plain data then."""
        texts = {_ABOUT: dict(self.about)} | ({_CAMERA: self.camera} if self.camera is not None else {})
        content: dict[str, Any] = {name: np.array(json.dumps(text)) for name, text in texts.items()}
        content |= self.arrays
        with path.open("wb") as file:  # by a name alone, NumPy would add its ending
            np.savez_compressed(file, **content)

    @classmethod
    def load(
        cls,
        path: Path,
        model: str,
        specs: Mapping[str, ArraySpec],
        parse_camera: Callable[[Any], Any] | None = None,
    ) -> WeightsArchive:
        """Read an archive and check it.

        Args:
            path: of the file.
            model: which `peopleboy train` writes such a file.
            specs: what each array must be.
            parse_camera: makes a camera of plain data; left out for weights that hold for any camera.

        Raises:
            BadInput: a file that is missing, or holds other weights.
        """
        hint = f"`peopleboy train {model}` makes one"
        with open_archive(path, f"peopleboy train {model}") as archive:
            about = {str(key): str(text) for key, text in json.loads(str(archive[_ABOUT])).items()}
            camera = parse_camera(json.loads(str(archive[_CAMERA]))) if parse_camera else None
            arrays = {name: np.asarray(archive[name]) for name in specs if name in archive}
        sizes: dict[str, int] = {}
        for name, spec in specs.items():
            if name not in arrays:
                raise BadInput(f"has no {name}; {hint}", file=str(path))
            if not spec.is_met(arrays[name], sizes):
                found = f"{arrays[name].dtype} {arrays[name].shape}"
                raise BadInput(f"{name} must be {spec}, got {found}; {hint}", file=str(path))
        return cls(arrays, about, camera)
