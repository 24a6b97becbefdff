"""Kinds of TIFF that Pillow does not read: floats of 64 and 16 bits, signed counts, 16 bits a channel."""

import struct
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, TiffImagePlugin, UnidentifiedImageError

from peopleboy.bad_input import BadInput

Raw = NDArray[Any]
"""(H, W) uint8, uint16 or float32, or (H, W, 3) uint8 RGB."""

_SUFFIXES: Final = (".tif", ".tiff")
_WIDTH, _HEIGHT, _BITS, _COMPRESSION, _OFFSETS, _CHANNELS, _COUNTS, _PREDICTOR, _FORMAT = (
    256, 257, 258, 259, 273, 277, 279, 317, 339,
)  # fmt: skip
_ORIENTATION: Final = 274
_TURNED: Final = (5, 6, 7, 8)
_UNPACKED: Final = 1
_DEFLATED: Final = (8, 32946)
_SIGNED, _FLOAT = 2, 3
_HALF_BITS: Final = 16


def other_tiff(path: Path, notes: list[str]) -> list[Raw] | None:
    """Read all pages of a TIFF that Pillow does not read, or reads as something else.

    Floats become float32. Signed counts become uint16 if none is negative, otherwise float32. Three equal
    channels of 16 bits become one.

    Args:
        path: the file.
        notes: list to which a note is added on what is not kept.

    Returns:
        The pages; None for any other file.

    Raises:
        BadInput: pixels are of a kind that is not read.
    """
    if path.suffix.lower() not in _SUFFIXES or not path.is_file():
        return None
    tags = _tags_of(path)
    if not tags:
        return None
    bits, kind = _first(tags, _BITS, 1), _first(tags, _FORMAT, 1)
    if kind == _FLOAT and bits == _HALF_BITS:
        return [_read_half(path, tags)]
    if not ((kind == _SIGNED and bits == _HALF_BITS) or (_first(tags, _CHANNELS, 1) > 1 and bits > 8)):
        try:
            with Image.open(path):
                return None
        except UnidentifiedImageError:
            pass  # OpenCV may read it
        except (OSError, SyntaxError, ValueError):
            return None
    is_read, pages = cv2.imreadmulti(str(path), flags=cv2.IMREAD_UNCHANGED)
    if not is_read or not pages:
        return None
    return [_as_raw(path, np.asarray(page), notes) for page in pages]


def _as_raw(path: Path, page: Raw, notes: list[str]) -> Raw:
    if page.dtype in (np.float64, np.float16, np.float32) and page.ndim == 2:
        return page.astype(np.float32)
    if page.dtype in (np.int16, np.int32) and page.ndim == 2:
        is_count = page.min() >= 0 and page.max() <= np.iinfo(np.uint16).max
        return page.astype(np.uint16 if is_count else np.float32)
    if page.dtype == np.uint16 and page.ndim == 3:
        colours = page[..., :3]
        if (colours == colours[..., :1]).all():
            return np.ascontiguousarray(page[..., 0])
        note = "pictures have 16 bits a channel, of which 8 are read"
        if note not in notes:
            notes.append(note)
        return np.ascontiguousarray((colours >> 8).astype(np.uint8)[..., ::-1])
    if page.dtype in (np.uint8, np.uint16) and page.ndim == 2:
        return page
    raise BadInput(f"{path}: has pixels of {page.dtype}, which are not read; convert them to 32-bit floats")


def _tags_of(path: Path) -> dict[int, Any]:
    """Return the tags of a TIFF's first page; none if the file is no TIFF, or damaged."""
    try:
        with path.open("rb") as file:
            header = file.read(8)
            if header[:4] not in (b"II*\0", b"MM\0*"):
                return {}
            directory = TiffImagePlugin.ImageFileDirectory_v2(header)
            file.seek(directory.next)
            directory.load(file)
            return dict(directory)
    except (OSError, SyntaxError, ValueError, KeyError, TypeError, EOFError):
        return {}


def without_orientation(path: Path) -> tuple[bytes, int] | None:
    """Return a TIFF as if it were upright, and its orientation; None if it is not turned by 90 degrees.

    Pillow exchanges width and height of such pages twice.
    """
    tags = _tags_of(path) if path.suffix.lower() in _SUFFIXES else {}
    turned = _first(tags, _ORIENTATION, 1)
    if turned not in _TURNED:
        return None
    content = bytearray(path.read_bytes())
    order = "<" if content[:2] == b"II" else ">"
    (at,) = struct.unpack_from(f"{order}I", content, 4)
    while 0 < at < len(content) - 2:
        (entries,) = struct.unpack_from(f"{order}H", content, at)
        for entry in range(at + 2, at + 2 + 12 * entries, 12):
            if struct.unpack_from(f"{order}H", content, entry)[0] == _ORIENTATION:
                struct.pack_into(f"{order}H", content, entry + 8, 1)
        (at,) = struct.unpack_from(f"{order}I", content, at + 2 + 12 * entries)
    return bytes(content), turned


def _first(tags: dict[int, Any], tag: int, default: int) -> int:
    value = tags.get(tag, default)
    return int(value[0] if isinstance(value, Sequence) else value)


def _read_half(path: Path, tags: dict[int, Any]) -> Raw:
    """Read a single page of 16-bit floats, in strips that are unpacked or deflated."""
    packing = _first(tags, _COMPRESSION, _UNPACKED)
    is_simple = packing in (_UNPACKED, *_DEFLATED) and _first(tags, _PREDICTOR, 1) == 1
    if not is_simple or _first(tags, _CHANNELS, 1) != 1 or _OFFSETS not in tags or _COUNTS not in tags:
        raise BadInput(f"{path}: has 16-bit floats that are packed; convert it to 32-bit floats")
    content = path.read_bytes()
    strips = [content[at : at + size] for at, size in zip(tags[_OFFSETS], tags[_COUNTS], strict=True)]
    try:
        data = b"".join(zlib.decompress(strip) if packing in _DEFLATED else strip for strip in strips)
        order = "<" if content[:2] == b"II" else ">"
        shape = _first(tags, _HEIGHT, 0), _first(tags, _WIDTH, 0)
        return np.frombuffer(data, f"{order}f2").reshape(shape).astype(np.float32)
    except (ValueError, zlib.error) as error:
        raise BadInput(f"{path}: is damaged; remove it, or repair it") from error
