import time
from pathlib import Path

import numpy as np
import pytest

from peopleboy.tracker.checked_tracker import CheckedTracker
from peopleboy.tracker.evaluation.evaluate import evaluate
from peopleboy.tracker.evaluation.latency import (
    LATENCY_FILE,
    WARM_UP,
    Latency,
    TimedImages,
    read_latency,
    write_latency,
)
from peopleboy.tracker.evaluation.table import to_json
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Track
from tests.helpers.calls.refused import refused
from tests.helpers.images.random_sequences import tracks_of, truth_of

RENDER_S, WORK_S = 0.2, 0.02


class SlowImages(TimedImages):
    """Images that take long to render."""

    def __getitem__(self, camera: str) -> np.ndarray:
        time.sleep(RENDER_S)
        return super().__getitem__(camera)


class Working:
    """A tracker that reads an image, and works for a while."""

    cameras = ("thermal",)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        assert "colour" not in frame.images
        frame.grey("thermal")
        time.sleep(WORK_S)
        return ()


def test_the_time_of_an_update_leaves_out_the_rendering_of_its_images() -> None:
    images = SlowImages({"thermal": np.zeros((4, 5), np.uint8)})
    checked = CheckedTracker(Working(), "working", ("thermal",))
    checked.update(Frame(images=images, time_s=0.0))
    (time_ms,) = checked.times_ms
    assert 1000.0 * WORK_S <= time_ms < 1000.0 * RENDER_S


def test_times_are_read_as_written_but_for_the_warm_up(tmp_path: Path) -> None:
    times_ms = np.arange(100.0)
    write_latency(tmp_path, times_ms)
    read = read_latency(tmp_path)
    assert read.time_ms.tolist() == times_ms[WARM_UP:].tolist()
    assert read.mean_ms == pytest.approx(np.mean(times_ms[WARM_UP:]))
    assert read.p95_ms == pytest.approx(np.percentile(times_ms[WARM_UP:], 95))
    assert len(read + read) == 2 * len(read)


def test_a_run_without_times_has_no_latency_among_its_metrics(tmp_path: Path) -> None:
    assert len(read_latency(tmp_path)) == 0
    scores = evaluate(truth_of([]), tracks_of([]))
    assert "latency" not in to_json(scores)
    assert np.isnan(scores.latency.p95_ms)


def test_other_text_than_times_is_refused(tmp_path: Path) -> None:
    (tmp_path / LATENCY_FILE).write_text("fast\n")
    with refused(LATENCY_FILE, "one time [ms] a line", "run the scenario again"):
        read_latency(tmp_path)


def test_the_mean_of_two_sequences_weighs_their_updates_alike() -> None:
    both = Latency(np.array([1.0, 1.0, 1.0])) + Latency(np.array([5.0]))
    assert both.mean_ms == 2.0
