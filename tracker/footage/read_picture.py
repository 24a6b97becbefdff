"""Reading pictures from files, one by one."""

import io
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from PIL import Image, UnidentifiedImageError

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.radiometric import is_radiometric, read_celsius
from peopleboy.tracker.footage.read_tiff import Raw, other_tiff, without_orientation
from peopleboy.user_files import check_plain
from peopleboy.wording import counted

_SIXTEEN_BIT: Final = ("I;16", "I;16B", "I;16L", "I")
_TIFF_STARTS: Final = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_KIND_OF_PAGE: Final = 254  # tag of TIFF, NewSubfileType
_NO_PAGE: Final = 1 | 4  # of its bits: a smaller copy of another page, a mask


def read_row(paths: Iterable[Path], notes: list[str]) -> Iterator[Raw]:
    """Read pictures one by one; all must have the size and the bit depth of the first.

    Raises:
        BadInput: a picture is damaged, or of another size or bit depth than the first.
    """
    return _alike((str(path), read_picture(path, notes)) for path in paths)


def read_picture(path: Path, notes: list[str]) -> Raw:
    """Read one picture: (H, W) uint8, uint16 or float32, or (H, W, 3) uint8.

    Raises:
        BadInput: it is damaged, of an unsupported kind, one of several in its file, or has pixels that are
            not finite.
    """
    if is_radiometric(path):
        return _finite(read_celsius(path, notes), str(path))
    if (others := other_tiff(path, notes)) is not None:
        _check_single(path, len(others))
        return _finite(others[0], str(path))
    with _opened(path) as image:
        _check_single(path, len(_pages_in(image)))
        return _finite(_as_array(image, path, notes), str(path))


def _check_single(path: Path, pages: int) -> None:
    if pages > 1:
        raise BadInput(
            f"{path}: has {pages} pages, and in a folder each picture is a file; give {path} alone"
        )


def count_pages(path: Path) -> int:
    """Count the pictures in a file, without a TIFF's thumbnails and masks.

    Raises:
        BadInput: it cannot be read.
    """
    if (others := other_tiff(path, [])) is not None:
        return len(others)
    with _opened(path) as image:
        return len(_pages_in(image))


def read_pages(path: Path, notes: list[str]) -> Iterator[Raw]:
    """Read the pictures in a file one by one, with the checks of `read_row`.

    Raises:
        BadInput: as in `read_row`.
    """
    return _alike(_each_page(path, notes))


def _each_page(path: Path, notes: list[str]) -> Iterator[tuple[str, Raw]]:
    if (others := other_tiff(path, notes)) is not None:
        for number, picture in enumerate(others, start=1):
            where = f"{path}: page {number}"
            yield where, _finite(picture, where)
        return
    with _opened(path) as image:
        for number, page in enumerate(_pages_in(image), start=1):
            image.seek(page)
            where = f"{path}: page {number}"
            yield where, _finite(_as_array(image, path, notes), where)


def _alike(pictures: Iterable[tuple[str, Raw]]) -> Iterator[Raw]:
    first: Raw | None = None
    for where, picture in pictures:
        first = picture if first is None else first
        if picture.shape[:2] != first.shape[:2]:
            raise BadInput(
                f"{where}: all pictures must have one size, {size_of(first)} as the first, "
                f"got {size_of(picture)}"
            )
        if picture.dtype != first.dtype:
            raise BadInput(f"{where}: all pictures must be {first.dtype} as the first, got {picture.dtype}")
        yield picture


@contextmanager
def _opened(path: Path) -> Iterator[Image.Image]:
    """Open a picture; errors describe the problem in one line."""
    check_plain(path)
    try:
        turned = without_orientation(path) if path.is_file() else None
        with Image.open(path if turned is None else io.BytesIO(turned[0])) as image:
            if turned is not None:
                image.info[_TURNED_BY] = turned[1]
            yield image
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        if isinstance(error, BadInput):
            raise
        raise BadInput(f"{path}: {_what_is_wrong(path, error)}") from error


def _pages_in(image: Image.Image) -> list[int]:
    """Return the indices of the pictures in a file: the pages of a TIFF; otherwise only the first."""
    if image.format != "TIFF":
        return [0]
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("error", "Corrupt EXIF data", UserWarning)
            kinds = [_kind_of(image, page) for page in range(int(getattr(image, "n_frames", 1)))]
    except (UserWarning, TypeError, EOFError) as error:  # raised by Pillow for a truncated file
        raise OSError("breaks off between its pages") from error
    image.seek(0)
    return [page for page, kind in enumerate(kinds) if not kind & _NO_PAGE] or [0]


def _kind_of(image: Image.Image, page: int) -> int:
    image.seek(page)
    return int(getattr(image, "tag_v2", {}).get(_KIND_OF_PAGE, 0))


def _what_is_wrong(path: Path, error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"cannot be read: {error.strerror}"
    if path.stat().st_size == 0:
        return "is empty; remove it, or repair it"
    if isinstance(error, UnidentifiedImageError) and _is_tiff(path):
        return "is a TIFF of a kind that is not read, such as 64-bit floats; convert it to 32-bit floats"
    if isinstance(error, UnidentifiedImageError):
        return f"is no {path.suffix[1:].upper()}, or damaged; remove it, or repair it"
    return f"cannot be read as a picture ({error}); remove it, or repair it"


def _is_tiff(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(4) in _TIFF_STARTS


_ORIENTATION: Final = 0x0112  # tag of EXIF
_TURNED_BY: Final = "peopleboy.orientation"
_TURNS: Final[Mapping[int, Callable[[Raw], Raw]]] = {
    2: np.fliplr,
    3: partial(np.rot90, k=2),
    4: np.flipud,
    5: lambda picture: np.swapaxes(picture, 0, 1),
    6: partial(np.rot90, k=-1),
    7: lambda picture: np.rot90(np.swapaxes(picture, 0, 1), k=2),
    8: partial(np.rot90, k=1),
}


def _as_array(opened: Image.Image, path: Path, notes: list[str]) -> Raw:
    """Return the pixels of a picture, the right way up."""
    array = _pixels_of(opened, path, notes)
    orientation = opened.info.get(_TURNED_BY) or opened.getexif().get(_ORIENTATION, 1)
    turn = _TURNS.get(int(orientation))  # Pillow has turned other TIFFs by now
    if turn is None:
        return array
    _note(notes, "pictures are turned as their EXIF orientation says")
    return np.ascontiguousarray(turn(array))


def _pixels_of(opened: Image.Image, path: Path, notes: list[str]) -> Raw:
    mode = opened.mode
    if mode == "RGB" and _has_deep_colours(opened):
        return _deep_grey(opened, path, notes)
    if mode in _SIXTEEN_BIT:
        counts = np.array(opened)
        if counts.min() < 0 or counts.max() > 65535:
            raise BadInput(f"{path}: counts must be 0..65535, got {counts.min()}..{counts.max()}")
        return counts.astype(np.uint16)
    if mode == "F":
        return np.array(opened, dtype=np.float32)
    if mode in ("L", "1"):
        return np.array(opened.convert("L"))
    if mode in ("RGBA", "LA", "PA"):
        _note(notes, "pictures have an opacity channel; it is left out")
    return np.array(opened.convert("L" if mode == "LA" else "RGB"))


def _has_deep_colours(opened: Image.Image) -> bool:
    """Return whether a PNG has 16 bits a channel, of which Pillow reads 8."""
    return opened.format == "PNG" and any("16" in str(tile[3]) for tile in getattr(opened, "tile", ()))


def _deep_grey(opened: Image.Image, path: Path, notes: list[str]) -> Raw:
    """Return the counts of three equal channels of 16 bits; otherwise 8 bits of each."""
    deep = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)  # which does not turn it
    if deep is not None and deep.dtype == np.uint16 and (deep == deep[..., :1]).all():
        return np.ascontiguousarray(deep[..., 0])
    _note(notes, "pictures have 16 bits a channel, of which 8 are read")
    return np.array(opened)


def _finite(picture: Raw, where: str) -> Raw:
    if picture.dtype == np.float32 and not np.isfinite(picture).all():
        broken = counted(int((~np.isfinite(picture)).sum()), "pixel")
        raise BadInput(f"{where}: has {broken} without a finite number; fill or mask them before")
    return picture


def _note(notes: list[str], text: str) -> None:
    if text not in notes:
        notes.append(text)


def size_of(picture: Raw) -> str:
    """Write a picture's size as WIDTHxHEIGHT."""
    return f"{picture.shape[1]}x{picture.shape[0]}"
