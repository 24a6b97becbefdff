import threading
import time

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.live_footage import (
    LiveFootage,
    LiveSource,
    PixelFormat,
    RawFormat,
    is_live,
    parse_size,
)


class Played(LiveSource):
    """Images that a test hands over one by one."""

    def images(self):
        for number in range(1, 10):
            yield np.full((30, 40), number, np.uint8)


def test_the_newest_image_is_taken_and_the_others_are_counted_as_dropped():
    footage, seen = LiveFootage(Played("0")), []
    for image in footage:
        seen.append(int(image[0, 0]))
        time.sleep(0.05)  # all other images come meanwhile
    assert seen[-1] == 9
    assert seen == sorted(seen)
    assert footage.received == 9
    assert footage.dropped == 9 - len(seen)
    assert len(footage.times_s) == len(seen)
    assert f"{footage.dropped} of 9 images dropped" in footage.notes[-1]


def test_times_follow_the_given_rate_however_fast_images_come():
    footage = LiveFootage(Played("0"), rate_hz=30.0)
    numbers = [int(image[0, 0]) for image in footage]
    assert footage.times_s == pytest.approx([(number - 1) / 30.0 for number in numbers])


def test_a_stopped_source_ends_after_the_present_image():
    class Endless(LiveSource):
        def images(self):
            while True:
                time.sleep(0.001)
                yield np.zeros((30, 40), np.uint8)

    footage, count = LiveFootage(Endless("0")), 0
    for _ in footage:
        count += 1
        if count == 3:
            footage.stop()
    assert count == 3


def test_a_silent_source_can_be_stopped():
    class Silent(LiveSource):
        def images(self):
            time.sleep(60.0)
            yield np.zeros((30, 40), np.uint8)

    footage = LiveFootage(Silent("0"))
    threading.Timer(0.1, footage.stop).start()
    with pytest.raises(BadInput, match="no image came"):
        list(footage)


@pytest.mark.parametrize(
    ("pixels", "content", "value"),
    [
        (PixelFormat.GREY8, b"\x05" * 6, 5),
        (PixelFormat.GREY16, b"\x05\x01" * 6, 261),
        (PixelFormat.GREY16_BIG_ENDIAN, b"\x01\x05" * 6, 261),
        (PixelFormat.RGB, b"\x01\x02\x03" * 6, [1, 2, 3]),
        (PixelFormat.BGR, b"\x03\x02\x01" * 6, [1, 2, 3]),
    ],
)
def test_raw_pixels_are_read_by_their_format(pixels, content, value):
    raw = RawFormat((3, 2), pixels)
    assert raw.size_bytes == len(content)
    image = raw.image(content)
    assert image.shape[:2] == (2, 3)
    assert image[1, 2].tolist() == value


def test_what_is_live_is_seen_from_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert all(map(is_live, ("0", "-", "rtsp://camera/stream", "/dev/video0")))
    assert not any(map(is_live, ("clip", "clip/1", "film.mkv", "/dev/zero")))
    (tmp_path / "0").mkdir()
    assert not is_live("0")


def test_passwords_do_not_appear_in_names():
    assert LiveSource("rtsp://me:secret@camera:554/live?token=secret").name == "rtsp://camera:554/live"


@pytest.mark.parametrize("text", ["640", "640x", "0x512", "640 x 512", "-1x5"])
def test_a_size_that_is_none_is_refused(text):
    with pytest.raises(BadInput, match="--size"):
        parse_size(text)
