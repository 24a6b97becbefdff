"""Read thermal clips with boxes of people, rendered or real, and cut patches from them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.footage.footage_truth import NAMES, load_truth
from peopleboy.tracker.footage.image_sequences import INNER, PictureFolder
from peopleboy.tracker.footage.picture_names import pictures_in
from peopleboy.tracker.footage.read_picture import read_picture, size_of
from peopleboy.user_files import read_json

Grey = NDArray[np.uint8]

ROWS: Final = 192
"""Height to which all pictures are shrunk, so that a pixel covers the same share of the field of view."""

_BESIDE: Final = ("gt.txt", *NAMES)
_VISIBLE: Final = 0.7


@dataclass(frozen=True, slots=True, eq=False)
class ClipFrame:
    """One picture, the next one, and the people in it.

    Attributes:
        grey: (H, W) uint8, as it was recorded.
        later: (H, W) uint8, the next picture; None after the last one.
        boxes: (N, 4) [px] left, top, width, height of all people.
        clear: (N,) whether each person is mostly visible, and inside the picture.
    """

    grey: Grey
    later: Grey | None
    boxes: NDArray[np.float64]
    clear: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """A sequence of pictures with ground truth.

    Attributes:
        name: name of its folder.
        scene: the scene; clips of one scene are never split between training and test.
        paths: files of the pictures.
        truth: ground truth boxes, by frame from 1.
    """

    name: str
    scene: str
    paths: tuple[Path, ...]
    truth: TrueBoxes

    def moments(self, count: int) -> Iterator[ClipFrame]:
        """Yield some pictures, spread evenly over the clip.

        Raises:
            BadInput: a picture is not 8-bit grey, is too small, or has another size than the first.
        """
        first: Grey | None = None
        chosen = np.linspace(0, max(len(self.paths) - 2, 0), min(count, len(self.paths)))
        for index in np.unique(chosen.round().astype(int)):
            grey = _read(self.paths[index])
            first = grey if first is None else first
            if grey.shape != first.shape:
                raise BadInput(
                    f"{self.paths[index]}: all pictures must have the size of the first, {size_of(first)}, "
                    f"got {size_of(grey)}"
                )
            later = _read(self.paths[index + 1]) if index + 1 < len(self.paths) else None
            rows = self.truth.frame == index + 1
            boxes = self.truth.box[rows]
            clear = (self.truth.visible[rows] >= _VISIBLE) & _is_inside(boxes, grey.shape)
            yield ClipFrame(grey, later, boxes, clear)


def find_clips(folders: Sequence[Path]) -> list[Clip]:
    """Find the clips in these folders: clips, runs, or sets of them.

    Raises:
        BadInput: a folder has no pictures, no ground truth, or an unreadable one.
    """
    return [clip for folder in folders for home in _homes(folder) for clip in (_clip(home),)]


def _homes(folder: Path) -> list[Path]:
    if not folder.is_dir():
        raise BadInput(f"{folder}: no such folder")
    if _pictures_of(folder) is not None:
        return [folder]
    within = [path for path in sorted(folder.iterdir()) if path.is_dir() and _pictures_of(path) is not None]
    if not within:
        frames = "; `peopleboy run --frames` writes them" if (folder / "run.json").is_file() else ""
        raise BadInput(f"{folder}: has no pictures in thermal/, nor any folders with thermal/{frames}")
    return within


def _pictures_of(folder: Path) -> Path | None:
    """Return the folder with the pictures; None without any. A run never has pictures at its top level."""
    inner = [folder / name for name in reversed(INNER) if (folder / name).is_dir()]
    if not (folder / "run.json").is_file():
        inner.append(folder)
    return next((path for path in inner if pictures_in(path)), None)


def _clip(folder: Path) -> Clip:
    home = _pictures_of(folder)
    assert home is not None
    truth = next((folder / name for name in _BESIDE if (folder / name).is_file()), None)
    if truth is None:
        raise BadInput(f"{folder}: has no boxes of people; add one of {', '.join(_BESIDE)}")
    film = PictureFolder(home, folder.resolve().name)
    given = load_truth(truth, film.expected, film.numbers)
    return Clip(film.name, _scene(folder), tuple(film.paths), given.truth)


def _scene(folder: Path) -> str:
    """Return the scene of a clip: the scenario for a run, whatever its seed, else the folder."""
    try:
        return str(read_json(folder / "run.json")["scenario"])
    except (OSError, ValueError, KeyError):
        return str(folder.resolve())


def _read(path: Path) -> Grey:
    picture = read_picture(path, [])
    if picture.ndim == 3:
        if (picture != picture[..., :1]).any():
            raise BadInput(f"{path}: must be grey, got a colour picture")
        picture = picture[..., 0]
    if picture.dtype != np.uint8:
        raise BadInput(f"{path}: must have 8 bits, as in thermal/ of a run, got {picture.dtype}")
    if min(picture.shape) < ROWS:
        raise BadInput(f"{path}: must be at least {ROWS} x {ROWS} pixels, got {size_of(picture)}")
    return np.ascontiguousarray(picture)


def _is_inside(boxes: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.bool_]:
    left, top, width, height = boxes.T
    inside: NDArray[np.bool_] = (
        (left >= 0) & (top >= 0) & (left + width <= shape[1]) & (top + height <= shape[0])
    )
    return inside


# Patches of 32 x 32 pixels at equal scale: from anywhere, from the background, and of people.

SIDE: Final = 32
"""Rows and columns of a patch."""

_ROOM: Final = 1.25  # side of the square around a person, in heights of the person
_TRIES: Final = 12


def shrunk(grey: Grey) -> Grey:
    """Shrink a picture (H, W) to `ROWS` rows; every pixel is the mean of the pixels that it covers."""
    factor = ROWS / grey.shape[0]
    width = round(grey.shape[1] * factor)
    return np.asarray(cv2.resize(grey, (width, ROWS), interpolation=cv2.INTER_AREA), np.uint8)


def covered(shape: tuple[int, ...], boxes: NDArray[np.float64], grown: float = 0.15) -> NDArray[np.bool_]:
    """Return a mask (H, W) of boxes (N, 4), each enlarged by a share of its size on every side."""
    mask = np.zeros(shape[:2], bool)
    for left, top, width, height in boxes:
        x0, y0 = left - grown * width, top - grown * height
        x1, y1 = left + (1.0 + grown) * width, top + (1.0 + grown) * height
        mask[max(int(y0), 0) : max(int(np.ceil(y1)), 0), max(int(x0), 0) : max(int(np.ceil(x1)), 0)] = True
    return mask


def random_patches(moment: ClipFrame, count: int, rng: np.random.Generator) -> list[Grey]:
    """Cut patches at random places of the shrunken picture."""
    picture = shrunk(moment.grey)
    return [_cut(picture, *_corner(picture, rng)) for _ in range(count)]


def background_patches(
    moment: ClipFrame, count: int, rng: np.random.Generator, side: int = SIDE
) -> list[Grey]:
    """Cut patches of the shrunken picture that overlap no person's box; fewer if there is no room."""
    picture = shrunk(moment.grey)
    return [_cut(picture, *corner, side) for corner in background_corners(moment, count, rng, side)]


def background_corners(
    moment: ClipFrame, count: int, rng: np.random.Generator, side: int
) -> list[tuple[int, int]]:
    """Choose rows and columns of background patches."""
    factor = ROWS / moment.grey.shape[0]
    picture = shrunk(moment.grey)
    taken = covered(picture.shape, moment.boxes * factor)
    found: list[tuple[int, int]] = []
    for _ in range(_TRIES * count):
        row, column = _corner(picture, rng, side)
        if len(found) < count and not taken[row : row + side, column : column + side].any():
            found.append((row, column))
    return found


def person_patches(moment: ClipFrame) -> list[Grey]:
    """Cut a square around every clear person, shrunk to equal height; smaller people are omitted."""
    return [
        _square(moment.grey, box)
        for box in moment.boxes[moment.clear]
        if _ROOM * box[3] >= SIDE and box[2] <= _ROOM * box[3]
    ]


def _square(grey: Grey, box: NDArray[np.float64]) -> Grey:
    left, top, width, height = box
    side = round(_ROOM * height)
    row, column = round(top + height / 2.0 - side / 2.0), round(left + width / 2.0 - side / 2.0)
    wide = cv2.copyMakeBorder(grey, side, side, side, side, cv2.BORDER_REFLECT_101)
    part = wide[row + side : row + 2 * side, column + side : column + 2 * side]
    return np.asarray(cv2.resize(part, (SIDE, SIDE), interpolation=cv2.INTER_AREA), np.uint8)


def _corner(picture: Grey, rng: np.random.Generator, side: int = SIDE) -> tuple[int, int]:
    return int(rng.integers(picture.shape[0] - side + 1)), int(rng.integers(picture.shape[1] - side + 1))


def _cut(picture: Grey, row: int, column: int, side: int = SIDE) -> Grey:
    return picture[row : row + side, column : column + side].copy()
