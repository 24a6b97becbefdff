"""Draw the contact sheet of a run: its key moments in columns, with tracks and ground truth drawn in.

Each moment shows the thermal image above the colour image, then the images of further cameras, with their
names.
"""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont
from PIL.PngImagePlugin import PngInfo

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.key_moments import KeyMoment, KeyMoments, Shot
from peopleboy.scenarios.drawing.overlay import (
    Picture,
    Plate,
    as_picture,
    draw_tracks_of,
    draw_truth,
    enlarge,
    people_parts,
    show_thermal,
)
from peopleboy.scenarios.drawing.palette import TRUTH, Rgb, track_colour
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.scenarios.run_folder.atomic_output import writing_to
from peopleboy.sim.cameras.kinds import kind_of
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.tracker.track import Track
from peopleboy.wording import counted

HEAD_PX: Final = 76
MARGIN_PX: Final = 24
PAGE: Final[Rgb] = (22, 24, 28)
STRONG: Final[Rgb] = (240, 240, 240)
WEAK: Final[Rgb] = (165, 170, 178)

_TRUTH_LEGEND: Final = "dashed: ground truth with visible fraction"
_TRACK_LEGEND: Final = "solid: tracks with id and confidence; dim with ?: tentative"


def draw_head(page: Image.Image, title: str, length: str, *, has_truth: bool = True) -> None:
    """Write title, length and legend across the top `HEAD_PX` rows of a page; a long title is cut."""
    draw = ImageDraw.Draw(page)
    lines = [(length, WEAK), (_TRUTH_LEGEND, TRUTH), (_TRACK_LEGEND, track_colour(1))]
    shown = [line for line in lines if has_truth or line[1] != TRUTH]
    for row, (text, colour) in enumerate(shown):
        draw.text((page.width - MARGIN_PX, 16 + 21 * row), text, colour, font(15), anchor="rm")
    room = page.width - 3 * MARGIN_PX - max(draw.textlength(text, font(15)) for text, _ in shown)
    large = font(26, is_bold=True)
    draw.text((MARGIN_PX, 34), cut(draw, title, large, room), STRONG, large, anchor="lm")


def cut(draw: ImageDraw.ImageDraw, text: str, letters: ImageFont.FreeTypeFont, room_px: float) -> str:
    """Shorten a text with an ellipsis until it fits a width."""
    while draw.textlength(text, letters) > room_px:
        text = f"{text[:-2]}…"
    return text


@cache
def font(size: int, *, is_bold: bool = False) -> ImageFont.FreeTypeFont:
    """Return the font of all sheets in a size."""
    name = "DejaVuSans-Bold.ttf" if is_bold else "DejaVuSans.ttf"
    return ImageFont.truetype(Path(matplotlib.get_data_path(), "fonts", "ttf", name), size)


WIDTH_PX: Final = 1600
COLUMNS: Final = 4
MOMENTS: Final = 12

_GAP, _CAPTION, _SEAM = 14, 46, 3
_TILE: Final = (WIDTH_PX - 2 * MARGIN_PX - (COLUMNS - 1) * _GAP) // COLUMNS
_WIDE: Final = 2.5  # times as wide as high
_AXIS_PX: Final = 18
_NAME_PX: Final = 19
_TICKS_DEG: Final = (180, 90, 0, -90, -180)
_NOTE: Final = "Moments"  # key of the PNG text that lists the place and content of each tile
_CHIP: Final[Rgb] = (58, 64, 74)


@dataclass(frozen=True, slots=True, eq=False)
class Tile:
    """One moment of a sheet that was read back: its images without the caption, and the caption's text."""

    picture: Image.Image
    words: str


class ContactSheet:
    """Collects the key moments of a run and draws them.

    Args:
        title: heading of the sheet.
        robot: the robot that carries the cameras; the default robot if None.
    """

    def __init__(self, title: str, robot: RobotConfig | None = None) -> None:
        self._title = title
        self._robot = RobotConfig() if robot is None else robot
        self._moments = KeyMoments(self._robot.cameras)
        self._last: Tick | None = None

    def add(self, tick: Tick, events: Sequence[LogLine]) -> None:
        """Add one tick and its events; only a few ticks are kept."""
        self._moments.add(tick, events)
        self._last = tick

    def save(self, path: Path) -> None:
        """Write the sheet as a PNG.

        Raises:
            BadInput: it cannot be written there.
        """
        with writing_to(path):
            page, note = self._drawn()
            page.save(path, compress_level=1, pnginfo=note)

    def draw(self) -> Image.Image:
        """Draw the sheet, `WIDTH_PX` wide."""
        return self._drawn()[0]

    def _drawn(self) -> tuple[Image.Image, PngInfo]:
        """Draw the sheet, with a note of each moment's box (left, top, right, bottom) and caption."""
        moments = self._moments.choose(MOMENTS)
        tiles = [self._tile(moment) for moment in moments]
        rows = [slice(start, start + COLUMNS) for start in range(0, len(tiles), COLUMNS)]
        heights = [max(tile.height for tile in tiles[row]) for row in rows]
        bottom = HEAD_PX + sum(heights) + _GAP * (len(rows) - 1) + MARGIN_PX
        page, places = Image.new("RGB", (WIDTH_PX, bottom), PAGE), []
        draw_head(page, self._title, self._length())
        top = HEAD_PX
        for row, height in zip(rows, heights, strict=True):
            for column, (moment, tile) in enumerate(zip(moments[row], tiles[row], strict=True)):
                left = MARGIN_PX + column * (_TILE + _GAP)
                page.paste(tile, (left, top))
                words = f"{moment.time_s:.1f} s: {'; '.join(moment.words)}"
                places.append({"box": [left, top + _CAPTION, left + _TILE, top + height], "words": words})
            top += height + _GAP
        note = PngInfo()
        note.add_text(_NOTE, json.dumps(places))
        return page, note

    def _length(self) -> str:
        if self._last is None:
            return counted(0, "frame")
        return f"{counted(self._last.frame, 'frame')}, {self._last.observation.time_s:.1f} s"

    def _tile(self, moment: KeyMoment) -> Image.Image:
        """Draw one moment: caption, thermal, colour, then further cameras."""
        further = _rows_of(moment.further)
        rows = [[self._thermal_picture(moment)], [self._colour_picture(moment)]]
        rows += [[self._further_picture(shot, len(row), moment) for shot in row] for row in further]
        heights = [max(picture.shape[0] for picture in row) for row in rows]
        tile = Image.new("RGB", (_TILE, _CAPTION + sum(heights) + _SEAM * (len(rows) - 1)), PAGE)
        _caption(tile, moment)
        top = _CAPTION
        for row, height in zip(rows, heights, strict=True):
            for column, picture in enumerate(row):
                tile.paste(Image.fromarray(picture), (column * (_share(len(row)) + _SEAM), top))
            top += height + _SEAM
        return tile

    def _thermal_picture(self, moment: KeyMoment) -> Picture:
        scale = _fitting_scale(moment.thermal, _TILE)
        picture = enlarge(show_thermal(moment.thermal), scale)
        plates: list[Plate] = []
        picture = self._with_tracks("thermal", picture, moment.tracks, scale, moment.explanation, plates)
        return draw_truth(picture, moment.people, scale, plates=plates)

    def _colour_picture(self, moment: KeyMoment) -> Picture:
        scale = _fitting_scale(moment.colour, _TILE)
        picture = enlarge(moment.colour, scale)
        return self._with_tracks("colour", picture, moment.tracks, scale, moment.explanation, [])

    def _further_picture(self, shot: Shot, beside: int, moment: KeyMoment) -> Picture:
        """Draw the image of a further camera with its tracks, ground truth boxes if any, name and age."""
        scale = _fitting_scale(shot.image, _share(beside))
        config = self._robot.cameras[shot.camera]
        picture, camera = enlarge(as_picture(shot.image), scale), config.camera
        if kind_of(config).has_boxes:
            plates: list[Plate] = []
            picture = self._with_tracks(shot.camera, picture, shot.tracks, scale, None, plates)
            picture = draw_truth(picture, people_parts(shot.people, camera), scale, plates=plates)
        age_s = moment.time_s - shot.time_s
        name = f"{shot.camera}, {age_s:.1f} s old" if age_s > 1e-6 else shot.camera
        return _framed(picture, name) if isinstance(camera, Panorama) else _named(picture, name)

    def _with_tracks(
        self,
        camera: str,
        picture: Picture,
        tracks: Sequence[Track],
        scale: float,
        explanation: object,
        plates: list[Plate],
    ) -> Picture:
        cameras = self._robot.cameras
        return draw_tracks_of(camera, picture, tracks, cameras, scale, explanation, plates)


def _rows_of(shots: Sequence[Shot]) -> list[Sequence[Shot]]:
    """Arrange further cameras in rows: two side by side, then each wide image in a row of its own."""
    wide = [shot for shot in shots if shot.image.shape[1] > _WIDE * shot.image.shape[0]]
    others = [shot for shot in shots if shot.image.shape[1] <= _WIDE * shot.image.shape[0]]
    return [*(others[k : k + 2] for k in range(0, len(others), 2)), *([shot] for shot in wide)]


def _fitting_scale(image: Picture, room_px: int) -> float:
    """Return the scale at which an image fills a width and is at most twice as high as that width."""
    height, width = image.shape[:2]
    return float(min(room_px / width, 2.0 * room_px / height))


def _share(pictures: int) -> int:
    """Return the width [px] of each picture in a row of this many."""
    return (_TILE - _SEAM * (pictures - 1)) // pictures


def _framed(picture: Picture, name: str) -> Picture:
    """Add a name above a panorama and an axis of bearings below it."""
    above = np.full((_NAME_PX, *picture.shape[1:]), PAGE, np.uint8)
    return _named(np.concatenate([above, picture, _bearings(picture.shape[1])]), name)


def _named(picture: Picture, name: str) -> Picture:
    """Write a name in the upper left corner of a picture."""
    page = Image.fromarray(picture)
    draw = ImageDraw.Draw(page)
    draw.rectangle((0, 0, draw.textlength(name, font(12)) + 10, _NAME_PX - 1), PAGE)
    draw.text((5, 9), name, STRONG, font(12), anchor="lm")
    return np.asarray(page, np.uint8)


def _bearings(width: int) -> Picture:
    """Draw the axis of bearings of a panorama with this width [px]."""
    axis = Image.new("RGB", (width, _AXIS_PX), PAGE)
    draw, letters = ImageDraw.Draw(axis), font(11)
    for bearing in _TICKS_DEG:
        x = (0.5 - math.radians(bearing) / math.tau) * (width - 1)
        words = f"{bearing}°"
        half = draw.textlength(words, letters) / 2.0
        draw.line((x, 0, x, 4), WEAK)
        draw.text((min(max(x, half), width - half), 11), words, WEAK, letters, anchor="mm")
    return np.asarray(axis, np.uint8)


def read_tiles(path: Path) -> list[Tile]:
    """Read the tiles of a saved sheet; without a note of their places the whole sheet is one tile.

    Raises:
        BadInput: the picture is missing or unreadable.
    """
    try:
        with Image.open(path) as opened:
            sheet = opened.convert("RGB")
            note = json.loads(opened.info.get(_NOTE, "[]"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: cannot be read as a contact sheet: {error}") from error
    tiles = [Tile(sheet.crop(tuple(one["box"])), one["words"]) for one in note]
    return tiles or [Tile(sheet, "key moments of the run")]


def _caption(tile: Image.Image, moment: KeyMoment) -> None:
    """Write time, mode and events above the images."""
    draw = ImageDraw.Draw(tile)
    draw.text((0, 11), f"{moment.time_s:.1f} s", STRONG, font(17, is_bold=True), anchor="lm")
    start = draw.textlength(f"{moment.time_s:.1f} s", font(17, is_bold=True)) + 10
    if moment.mode:
        end = start + draw.textlength(moment.mode, font(13)) + 14
        draw.rounded_rectangle((start, 2, end, 20), 9, _CHIP)
        draw.text((start + 7, 11), moment.mode, STRONG, font(13), anchor="lm")
    draw.text((0, 33), _fitting(draw, moment.words, font(14)), WEAK, font(14), anchor="lm")


def _fitting(draw: ImageDraw.ImageDraw, words: Sequence[str], letters: ImageFont.FreeTypeFont) -> str:
    """Join as many texts as fit above a tile; shorten the first if it does not fit by itself."""
    text = words[0]
    for more in words[1:]:
        if draw.textlength(f"{text}; {more}", letters) > _TILE:
            break
        text = f"{text}; {more}"
    return cut(draw, text, letters, _TILE)
