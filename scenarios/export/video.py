"""MP4: thermal and colour side by side, or one camera, with ground truth and tracks: RUN.mp4."""

from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self

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
from peopleboy.scenarios.export.formats import need
from peopleboy.scenarios.export.replay import OneCamera, Play, one_camera
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.sim.cameras.kinds import kind_of
from peopleboy.sim.robot.robot_config import RobotConfig

_OPTION: Final = "--format mp4"
HEIGHT_PX: Final = 480
BAR_PX: Final = 32

_WIDEST_PX: Final = 4 * HEIGHT_PX  # of one image
_QUALITY: Final = "20"  # CRF: 0 is lossless, 18 visually lossless
_BAR: Final[Rgb] = (22, 24, 28)
_WORDS: Final[Rgb] = (225, 225, 225)
_FONT: Final = cv2.FONT_HERSHEY_SIMPLEX


def write_mp4(runs: Sequence[FinishedRun], folder: Path, play: Play, camera: str | None = None) -> None:
    """Write a video of each run that every browser plays: H.264, with the index in front.

    Args:
        runs: the runs to write.
        folder: output folder.
        play: returns the ticks of a run.
        camera: camera of the images; None for thermal and colour.

    Raises:
        BadInput: the package that encodes is not installed, or a run has no such camera.
    """
    need("av", _OPTION)
    shown = ("thermal", "colour") if camera is None else (camera,)
    for run in runs:
        _write_film(folder / f"{run.name}.mp4", [one_camera(run, name) for name in shown], play)


def _write_film(path: Path, shots: Sequence[OneCamera], play: Play) -> None:
    run, names = shots[0].run, [each.name for each in shots]
    with FilmWriter(path, shots[0].rate_hz, _OPTION) as film:
        for tick in (tick for tick in play(run) if tick.frame in shots[0].frames):
            film.add(draw_film_frame(tick, run.robot, run.title, names))


class FilmWriter:
    """Writes an H.264 video frame by frame; use it as a context manager.

    Args:
        path: file of the video.
        rate_hz: frames per second.
        option: the command-line option that requests it, for errors.

    Raises:
        BadInput: the package that encodes is not installed.
    """

    def __init__(self, path: Path, rate_hz: int, option: str) -> None:
        av = need("av", option)
        self._file: Any = av.open(str(path), "w", options={"movflags": "+faststart"})
        encoding = {"crf": _QUALITY, "preset": "veryfast"}
        self._stream: Any = self._file.add_stream("libx264", rate=rate_hz, options=encoding)
        self._stream.pix_fmt = "yuv420p"
        self._frame_of: Any = av.VideoFrame.from_ndarray
        self._is_new = True

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self._file.mux(self._stream.encode(None))
        self._file.close()

    def add(self, picture: Picture) -> None:
        """Add a frame; a last odd row or column is cut off, as H.264 requires even sizes."""
        height, width = (side // 2 * 2 for side in picture.shape[:2])
        if self._is_new:
            self._stream.height, self._stream.width = height, width
            self._is_new = False
        even = np.ascontiguousarray(picture[:height, :width])
        self._file.mux(self._stream.encode(self._frame_of(even, format="rgb24")))


def draw_film_frame(tick: Tick, robot: RobotConfig, title: str, cameras: Sequence[str]) -> Picture:
    """Draw one frame: the cameras from left to right, each `HEIGHT_PX` high, and a line of text above.

    Width and height are even, as H.264 with chroma subsampling requires.
    """
    images = np.concatenate([_picture(tick, name, robot) for name in cameras], axis=1)
    bar = np.full((BAR_PX, images.shape[1], 3), _BAR, np.uint8)
    words = f"{title}    {tick.observation.time_s:5.1f} s    {tick.mode}"
    cv2.putText(bar, words, (10, 21), _FONT, 0.5, _WORDS, 1, cv2.LINE_AA)
    legend = "dashed: ground truth, visible fraction"
    left = bar.shape[1] - _width(legend) - 10
    if left > _width(words) + 20:
        cv2.putText(bar, legend, (left, 21), _FONT, 0.5, TRUTH, 1, cv2.LINE_AA)
    return np.concatenate([bar, images])


def _width(words: str) -> int:
    """Return the width [px] of a text on the bar."""
    return int(cv2.getTextSize(words, _FONT, 0.5, 1)[0][0])


def _picture(tick: Tick, camera: str, robot: RobotConfig) -> Picture:
    """Draw the image of a camera with tracks and ground truth, if it has any."""
    image = show_image(tick.observation.images, camera, robot.cameras[camera])
    scale = min(HEIGHT_PX / image.shape[0], _WIDEST_PX / image.shape[1])
    picture, plates = enlarge(image, scale), list[Plate]()
    picture = draw_tracks_of(camera, picture, tick.tracks, robot.cameras, scale, tick.explanation, plates)
    if kind_of(robot.cameras[camera]).has_boxes:
        people = people_parts(tick.truths[camera].people, robot.cameras[camera].camera)
        picture = draw_truth(picture, people, scale, plates=plates)
    return _framed(picture)


def _framed(picture: Picture) -> Picture:
    """Cut off a last odd column, and centre a lower picture in `HEIGHT_PX` rows."""
    picture = picture[:HEIGHT_PX, : picture.shape[1] // 2 * 2]
    frame = np.full((HEIGHT_PX, picture.shape[1], 3), _BAR, np.uint8)
    top = (HEIGHT_PX - picture.shape[0]) // 2
    frame[top : top + picture.shape[0]] = picture
    return frame
