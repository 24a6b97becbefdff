"""MP4: thermal and colour side by side, with truth and tracks drawn in: RUN.mp4."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import cv2
import numpy as np

from peopleboy.scenarios.drawing.overlay import Picture, Plate, draw_tracks, draw_truth, enlarge, show_thermal
from peopleboy.scenarios.drawing.palette import TRUTH, Rgb
from peopleboy.scenarios.export.extra import need
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.sim.cameras.overlap import colour_from_thermal
from peopleboy.sim.robot.robot_config import RobotConfig

HEIGHT_PX: Final = 480
BAR_PX: Final = 32

_QUALITY: Final = "20"  # CRF: 0 loses nothing, 18 nothing to be seen
_BAR: Final[Rgb] = (22, 24, 28)
_WORDS: Final[Rgb] = (225, 225, 225)
_FONT: Final = cv2.FONT_HERSHEY_SIMPLEX


def write_mp4(runs: Sequence[FinishedRun], folder: Path, play: Play) -> None:
    """Write a film of each run that every browser shows: H.264, its index in front.

    Raises:
        BadInput: the package that encodes is not installed.
    """
    need("av", "mp4")
    for run in runs:
        _write_film(folder / f"{run.name}.mp4", run, play)


def _write_film(path: Path, run: FinishedRun, play: Play) -> None:
    import av

    with av.open(str(path), "w", options={"movflags": "+faststart"}) as film:
        stream = film.add_stream("libx264", rate=run.rate_hz, options={"crf": _QUALITY, "preset": "veryfast"})
        stream.pix_fmt = "yuv420p"
        for tick in play(run):
            picture = draw_film_frame(tick, run.robot, run.title)
            if tick.frame == 1:
                stream.height, stream.width = picture.shape[:2]
            film.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        film.mux(stream.encode(None))


def draw_film_frame(tick: Tick, robot: RobotConfig, title: str) -> Picture:
    """Draw one frame: thermal left, colour right, `HEIGHT_PX` high each, and a line of text above.

    Width and height are even, as H.264 with halved colour wants them.
    """
    images = np.concatenate([_thermal(tick), _colour(tick, robot)], axis=1)
    bar = np.full((BAR_PX, images.shape[1], 3), _BAR, np.uint8)
    words = f"{title}    {tick.observation.time_s:5.1f} s    {tick.mode}"
    cv2.putText(bar, words, (10, 21), _FONT, 0.5, _WORDS, 1, cv2.LINE_AA)
    legend = "dashed: truth, share visible"
    width = cv2.getTextSize(legend, _FONT, 0.5, 1)[0][0]
    cv2.putText(bar, legend, (bar.shape[1] - width - 10, 21), _FONT, 0.5, TRUTH, 1, cv2.LINE_AA)
    return np.concatenate([bar, images])


def _thermal(tick: Tick) -> Picture:
    thermal = tick.observation.images["thermal"]
    scale = HEIGHT_PX / thermal.shape[0]
    picture, plates = enlarge(show_thermal(thermal), scale), list[Plate]()
    picture = draw_tracks(picture, tick.tracks, scale, tick.explanation, plates=plates)
    return _even(draw_truth(picture, tick.truth.people, scale, plates=plates))


def _colour(tick: Tick, robot: RobotConfig) -> Picture:
    affine = colour_from_thermal(robot.cameras)
    colour = tick.observation.images["colour"]
    scale = HEIGHT_PX / colour.shape[0]
    picture, plates = enlarge(colour, scale), list[Plate]()
    picture = draw_tracks(picture, tick.tracks, scale, tick.explanation, affine, plates)
    return _even(draw_truth(picture, tick.truths["colour"].people, scale, plates=plates))


def _even(picture: Picture) -> Picture:
    """Cut a last odd column off."""
    return picture[:HEIGHT_PX, : picture.shape[1] // 2 * 2]
