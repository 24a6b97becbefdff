from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest

from peopleboy.scenarios.export.replay import replay
from peopleboy.scenarios.export.video import BAR_PX, HEIGHT_PX, draw_film_frame
from peopleboy.scenarios.run_folder.finished_run import open_run
from tests.helpers.runs.exported import export

BOTH = ("thermal", "colour")


@pytest.fixture(scope="module")
def film(crossing: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(crossing, "mp4", tmp_path_factory.mktemp("mp4") / "set") / "tiny-3.mp4"


@pytest.mark.thorough
def test_every_browser_can_play_the_film(film: Path) -> None:
    with av.open(str(film)) as opened:
        stream = opened.streams.video[0]
        assert (stream.codec_context.name, stream.pix_fmt, stream.average_rate) == ("h264", "yuv420p", 15)
        assert (stream.width, stream.height) == (2 * HEIGHT_PX * 4 // 3, HEIGHT_PX + BAR_PX)
        assert sum(1 for _ in opened.decode(stream)) == 60
    content = film.read_bytes()
    assert content.find(b"moov") < content.find(b"mdat")


@pytest.mark.slow
def test_its_pictures_are_those_drawn_from_the_run(film: Path, crossing: Path) -> None:
    run = open_run(crossing)
    drawn = next(
        draw_film_frame(tick, run.robot, "tiny, seed 3", BOTH) for tick in replay(run) if tick.frame == 30
    )
    with av.open(str(film)) as opened:
        shown = [frame.to_ndarray(format="rgb24") for frame in opened.decode(video=0)][29]
    assert np.abs(shown.astype(float) - drawn).mean() < 4.0


@pytest.mark.slow
def test_truth_and_tracks_are_drawn_on_both_images(crossing: Path) -> None:
    run = open_run(crossing)
    *_, picture = (draw_film_frame(tick, run.robot, "tiny", BOTH) for tick in replay(run) if tick.tracks)
    coloured = np.ptp(picture[BAR_PX:].astype(int), axis=2) > 100
    half = picture.shape[1] // 2
    assert coloured[:, :half].sum() > 200
    assert coloured[:, half:].sum() > 200
