"""Archive of learned weights: named arrays, a description of the training data, and the camera.

It is NumPy's `.npz` without pickles. The same content always gives the same bytes.
"""

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
"""Folder of the shipped weights."""

_ABOUT: Final = "about"
_CAMERA: Final = "camera"
# zipfile raises RuntimeError for an encrypted member, or an unknown compression.
_UNREADABLE: Final = (
    ValueError, KeyError, TypeError, AttributeError, EOFError, RuntimeError, SyntaxError, zipfile.BadZipFile,
    zlib.error,
)  # fmt: skip


@contextmanager
def open_archive(path: Path, command: str) -> Iterator[Mapping[str, Any]]:
    """Open a NumPy archive for reading, with errors that name the command that makes it.

    Raises:
        BadInput: the file is missing, invalid, or incomplete.
    """
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            yield archive
    except OSError as error:
        why = error.strerror or str(error)
        raise BadInput(f"cannot be read: {why}; `{command}` makes one", file=str(path)) from None
    except _UNREADABLE:
        raise BadInput(f"not a file of weights; `{command}` makes one", file=str(path)) from None


class ArraySpec(NamedTuple):
    """Specification of an array in an archive.

    Attributes:
        shape: sizes; a name stands for any size of at least 1, equal wherever the name occurs.
        dtype: of its numbers.
        may_be_infinite: whether infinite values are allowed; NaN is never allowed.
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
    """Content of a file of weights.

    Attributes:
        arrays: by name.
        about: description of the training data and the scores, for readers of the file.
        camera: camera of the training images; None for any.
    """

    arrays: Mapping[str, NDArray[Any]]
    about: Mapping[str, str] = field(default_factory=dict)
    camera: Any = None

    def save(self, path: Path) -> None:
        """Write the archive; the camera must be plain data."""
        texts = {_ABOUT: dict(self.about)} | ({_CAMERA: self.camera} if self.camera is not None else {})
        content: dict[str, Any] = {name: np.array(json.dumps(text)) for name, text in texts.items()}
        content |= self.arrays
        with path.open("wb") as file:  # given a name, NumPy would append its suffix
            np.savez_compressed(file, **content)

    @classmethod
    def load(
        cls,
        path: Path,
        model: str,
        specs: Mapping[str, ArraySpec],
        parse_camera: Callable[[Any], Any] | None = None,
    ) -> "WeightsArchive":
        """Read and check an archive.

        Args:
            path: of the file.
            model: name in `peopleboy train`, for messages.
            specs: specification of each array.
            parse_camera: makes a camera from plain data; None for weights without a camera.

        Raises:
            BadInput: the file is missing, or holds other weights.
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
