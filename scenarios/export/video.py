"""MP4: thermal and colour side by side, or one camera alone, with truth and tracks drawn in: RUN.mp4."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import cv2
import numpy as np

from peopleboy.scenarios.drawing.overlay import (
    Picture,
    Plate,
    draw_tracks_of,
    draw_truth,
    enlarge,
    people_parts,
    show_image,
)
from peopleboy.scenarios.drawing.palette import TRUTH, Rgb
from peopleboy.scenarios.export.camera_images import OneCamera, one_camera
from peopleboy.scenarios.export.formats import need
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.sim.cameras.kinds import kind_of
from peopleboy.sim.robot.robot_config import RobotConfig

HEIGHT_PX: Final = 480
BAR_PX: Final = 32

_WIDEST_PX: Final = 4 * HEIGHT_PX  # of one image
_QUALITY: Final = "20"  # CRF: 0 loses nothing, 18 nothing to be seen
_BAR: Final[Rgb] = (22, 24, 28)
_WORDS: Final[Rgb] = (225, 225, 225)
_FONT: Final = cv2.FONT_HERSHEY_SIMPLEX


def write_mp4(runs: Sequence[FinishedRun], folder: Path, play: Play, camera: str | None = None) -> None:
    """Write a film of each run that every browser shows: H.264, its index in front.

    Args:
        runs: which.
        folder: where the films go.
        play: gives a run's ticks.
        camera: whose images are shown; None for thermal and colour.

    Raises:
        BadInput: the package that encodes is not installed, or a run has no such camera.
    """
    need("av", "mp4")
    shown = ("thermal", "colour") if camera is None else (camera,)
    for run in runs:
        _write_film(folder / f"{run.name}.mp4", [one_camera(run, name) for name in shown], play)


def _write_film(path: Path, shots: Sequence[OneCamera], play: Play) -> None:
    import av

    run, rate = shots[0].run, shots[0].rate_hz
    names = [each.name for each in shots]
    with av.open(str(path), "w", options={"movflags": "+faststart"}) as film:
        stream = film.add_stream("libx264", rate=rate, options={"crf": _QUALITY, "preset": "veryfast"})
        stream.pix_fmt = "yuv420p"
        for tick in (tick for tick in play(run) if tick.frame in shots[0].frames):
            picture = draw_film_frame(tick, run.robot, run.title, names)
            if tick.frame == 1:
                stream.height, stream.width = picture.shape[:2]
            film.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        film.mux(stream.encode(None))


def draw_film_frame(tick: Tick, robot: RobotConfig, title: str, cameras: Sequence[str]) -> Picture:
    """Draw one frame: the cameras from left to right, `HEIGHT_PX` high each, and a line of text above.

    Width and height are even, as H.264 with halved colour wants them.
    """
    images = np.concatenate([_picture(tick, name, robot) for name in cameras], axis=1)
    bar = np.full((BAR_PX, images.shape[1], 3), _BAR, np.uint8)
    words = f"{title}    {tick.observation.time_s:5.1f} s    {tick.mode}"
    cv2.putText(bar, words, (10, 21), _FONT, 0.5, _WORDS, 1, cv2.LINE_AA)
    legend = "dashed: truth, share visible"
    left = bar.shape[1] - _width(legend) - 10
    if left > _width(words) + 20:
        cv2.putText(bar, legend, (left, 21), _FONT, 0.5, TRUTH, 1, cv2.LINE_AA)
    return np.concatenate([bar, images])


def _width(words: str) -> int:
    """How wide words are on the bar [px]."""
    return int(cv2.getTextSize(words, _FONT, 0.5, 1)[0][0])


def _picture(tick: Tick, camera: str, robot: RobotConfig) -> Picture:
    """Draw the image of a camera, tracks where they are known, and truth."""
    image = show_image(tick.observation.images, camera, robot.cameras[camera])
    scale = min(HEIGHT_PX / image.shape[0], _WIDEST_PX / image.shape[1])
    picture, plates = enlarge(image, scale), list[Plate]()
    picture = draw_tracks_of(camera, picture, tick.tracks, robot.cameras, scale, tick.explanation, plates)
    if kind_of(robot.cameras[camera]).has_boxes:
        people = people_parts(tick.truths[camera].people, robot.cameras[camera].camera)
        picture = draw_truth(picture, people, scale, plates=plates)
    return _framed(picture)


def _framed(picture: Picture) -> Picture:
    """Cut a last odd column off, and put a lower picture into the middle of `HEIGHT_PX` rows."""
    picture = picture[:HEIGHT_PX, : picture.shape[1] // 2 * 2]
    frame = np.full((HEIGHT_PX, picture.shape[1], 3), _BAR, np.uint8)
    top = (HEIGHT_PX - picture.shape[0]) // 2
    frame[top : top + picture.shape[0]] = picture
    return frame
