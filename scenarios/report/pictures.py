"""The pictures of a page: the worst moments of its runs, and their contact sheets."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.contact_sheet import read_tiles
from peopleboy.scenarios.drawing.overlay import encode_jpeg
from peopleboy.scenarios.report.charts.stills import DrawnFrame, Origin, show_frames
from peopleboy.scenarios.report.columns import Column, are_same_scene
from peopleboy.scenarios.report.findings.sentences import seconds
from peopleboy.scenarios.report.findings.summary import RunFindings
from peopleboy.scenarios.report.findings.worst_moments import BadMoment, worst_moments
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.tracker.frame import THERMAL

_JPEG_QUALITY, _TILE_QUALITY = 80, 72
_MOMENTS = 6  # of one run; of two side by side, each has half as many
_RUNS_SHOWN = 4  # of many runs, of which the worst moment is shown

_Stills = Mapping[str, Mapping[int, DrawnFrame]]  # by label of the column, then frame


class PagePicture(NamedTuple):
    """A picture inside the page: its data address, what it shows in words, and what is written below."""

    address: str
    words: str
    caption: str


class PicturedMoment(NamedTuple):
    """A bad moment, whose it is, its pictures, and where they are from."""

    moment: BadMoment
    whose: str
    pictures: Sequence[PagePicture]
    origins: Sequence[Origin]


def pictured_moments(columns: Sequence[Column]) -> list[PicturedMoment]:
    """Show the worst moments: of single runs in time, of many runs the worst of the worst runs.

    Single runs of the same scene are shown side by side at each moment.
    """
    singles = [column for column in columns if column.is_single]
    crowds = [column for column in columns if not column.is_single]
    count = max(_MOMENTS // max(len(singles), 1), 2)
    moments = {column.label: worst_moments(column.found, count) for column in singles}
    is_shared, is_beside = are_same_scene(columns), len(columns) > 1
    everything = [moment for of_run in moments.values() for moment in of_run]
    stills = {
        column.label: _stills(column.found, everything if is_shared else moments[column.label])
        for column in singles
    }
    shown = [
        _pictured(moment, label, stills if is_shared else {label: stills[label]}, is_beside)
        for label, of_run in moments.items()
        for moment in of_run
    ]
    return shown + [moment for column in crowds for moment in _of_many(column, is_beside)]


def contact_sheet(run: FinishedRun) -> list[PagePicture]:
    """The tiles of a run's contact sheet; none if it is gone."""
    try:
        tiles = [(tile.picture, tile.words) for tile in read_tiles(run.folder / "contact_sheet.png")]
    except BadInput:
        return []
    return [PagePicture(page_jpeg(np.asarray(picture), _TILE_QUALITY), said, said) for picture, said in tiles]


def _stills(found: RunFindings, moments: Sequence[BadMoment]) -> dict[int, DrawnFrame]:
    frames = sorted({frame for moment in moments for frame in moment.frames})
    return show_frames(found, [frame for frame in frames if frame <= found.run.frames])


def _of_many(column: Column, is_beside: bool) -> list[PicturedMoment]:
    label, moments = column.label, [(worst_moments(found, _MOMENTS), found) for found in column.runs]
    worst = [(max(of, key=lambda moment: moment.badness), found) for of, found in moments if of]
    worst.sort(key=lambda pair: -pair[0].badness)
    return [
        _pictured(moment, f"{label}, {found.run.title}", {label: _stills(found, [moment])}, is_beside)
        for moment, found in worst[:_RUNS_SHOWN]
    ]


def _pictured(moment: BadMoment, whose: str, stills: _Stills, is_beside: bool) -> PicturedMoment:
    """Give a moment its pictures; where columns stand beside each other, they are told apart."""
    seen = [(label, of[frame]) for frame in moment.frames for label, of in stills.items() if frame in of]
    pictures = []
    for label, still in seen:
        words = f"{moment.title}, {still.camera} image at {still.time_s:.1f} s, {label}"
        caption = f"{seconds(still.time_s)}{f', {label}' if is_beside else ''}"
        caption += "" if still.camera == THERMAL else f", {still.camera}"
        pictures.append(PagePicture(page_jpeg(still.picture, _JPEG_QUALITY), words, caption))
    return PicturedMoment(moment, whose, pictures, list(dict.fromkeys(still.origin for _, still in seen)))


def page_jpeg(image: NDArray[np.uint8], quality: int) -> str:
    """Give an image as an address for a page."""
    return f"data:image/jpeg;base64,{base64.b64encode(encode_jpeg(image, quality)).decode()}"
