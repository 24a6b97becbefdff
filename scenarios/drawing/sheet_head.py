"""The head of a contact sheet: what it shows, and how tracks and truth are drawn."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Final

import matplotlib
from PIL import Image, ImageDraw, ImageFont

from peopleboy.scenarios.drawing.palette import TRUTH, Rgb, track_colour

HEAD_PX: Final = 76
MARGIN_PX: Final = 24
PAGE: Final[Rgb] = (22, 24, 28)
STRONG: Final[Rgb] = (240, 240, 240)
WEAK: Final[Rgb] = (165, 170, 178)

_TRUTH_LEGEND: Final = "dashed: truth, with the share that is visible"
_TRACK_LEGEND: Final = "solid: tracks, with number and confidence; dim, with ?: not yet confirmed"


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
    """Cut a text to fit."""
    while draw.textlength(text, letters) > room_px:
        text = f"{text[:-2]}…"
    return text


@cache
def font(size: int, *, is_bold: bool = False) -> ImageFont.FreeTypeFont:
    """Give the letters of all sheets."""
    name = "DejaVuSans-Bold.ttf" if is_bold else "DejaVuSans.ttf"
    return ImageFont.truetype(Path(matplotlib.get_data_path(), "fonts", "ttf", name), size)
