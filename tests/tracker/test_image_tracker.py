import numpy as np
import pytest

from peopleboy import BadInput, ImageTracker
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.track_footage import track_footage
from peopleboy.tracker.evaluation.mot_files import track_line
from peopleboy.tracker.footage.image_sequences import open_footage
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import confirmed
from tests.helpers.images.footage_files import walker, write_counts

RATE_HZ = 15.0


def test_arrays_give_the_tracks_of_the_command(tmp_path):
    clip = write_counts(tmp_path / "clip", count=20)
    track_footage(TrackOptions(footage=clip, out=tmp_path / "out", rate_hz=RATE_HZ), lambda *_: None)
    tracker, lines = ImageTracker(), []
    for number, image in enumerate(open_footage(clip)):
        for track, box in confirmed(tracker.update(image, number / RATE_HZ), THERMAL):
            lines.append(track_line(number + 1, track.id, box, track.confidence))
    assert lines
    assert "".join(lines) == (tmp_path / "out" / "tracks.txt").read_text()


def test_boxes_enclose_whole_people_within_the_image():
    tracker = ImageTracker()
    for number in range(12):
        tracks = tracker.update(walker(number), number / RATE_HZ)
    boxes = [box for _, box in confirmed(tracks, THERMAL)]
    assert boxes
    for left, top, width, height in boxes:
        assert width == pytest.approx(0.4 * height, rel=0.3)  # the detector sees the edges
        assert min(left, top) >= 0.0
        assert left + width <= 160
        assert top + height <= 120


@pytest.mark.parametrize(
    ("image", "time_s", "words"),
    [
        (walker(1, (240, 320)), 1.0, "size of the first, 160x120, got 320x240"),
        (walker(1).astype(np.uint16), 1.0, "must be uint8 as the first"),
        (walker(1).astype(np.float64), 1.0, "got (120, 160) float64"),
        (walker(1), 0.0, "time_s must be later"),
        (walker(1), float("nan"), "time_s must be later"),
        (walker(1)[:20], 1.0, "at least 24x24"),
        ([[1, 2]], 1.0, "got list"),
    ],
)
def test_an_image_unlike_the_first_is_refused(image, time_s, words):
    tracker = ImageTracker()
    tracker.update(walker(0), 0.0)
    with pytest.raises(BadInput) as refused:
        tracker.update(image, time_s)
    assert words in str(refused.value)


def test_counts_of_unknown_temperature_are_noted():
    tracker = ImageTracker()
    tracker.update(walker(0).astype(np.uint16) * 100, 0.0)
    assert "temperatures are unknown" in tracker.notes[0]
