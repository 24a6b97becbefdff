import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image, TiffImagePlugin

from peopleboy.tracker.footage.grey import are_bytes_swapped
from peopleboy.tracker.footage.image_sequences import open_footage
from peopleboy.tracker.footage.picture_names import jumps, pictures_in
from peopleboy.tracker.footage.read_picture import read_picture
from tests.helpers.calls.footage_calls import call, refusal
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.images.footage_files import walker, write_folder


def named(*stems):
    return [Path(f"{stem}.png") for stem in stems]


def test_a_picture_that_is_there_as_two_kinds_of_file_is_refused(tmp_path):
    clip = write_folder(tmp_path / "clip", 3)
    cv2.imwrite(str(clip / "frame2.jpg"), walker(1))
    told = refusal(clip, "--out", tmp_path / "out")
    assert_names(told, clip, "frame2", ".jpg", ".png")


def test_numbers_that_jump_are_told_but_tracked(tmp_path):
    clip = write_folder(tmp_path / "clip", 6)
    (clip / "frame4.png").unlink()
    result = call(clip, "--out", tmp_path / "out")
    assert result.exit_code == 0
    assert_names(result.stderr, "note: ", "from 3 to 5")


def test_many_jumps_are_counted(tmp_path):
    clip = write_folder(tmp_path / "clip", 30)
    for gone in (3, 7, 12, 20, 25):
        (clip / f"frame{gone}.png").unlink()
    (note,) = open_footage(clip).notes
    assert "jump from 2 to 4, 6 to 8, 11 to 13 and 2 times more; frames" in note


@pytest.mark.parametrize(
    "stems",
    [
        ("a0", "a5", "a10", "a15"),  # a step of their own
        ("17001203", "17001270", "17001335", "17001403"),  # times
        ("seq1_f1", "seq1_f2", "seq2_f7", "seq2_f8"),  # two numbers
        ("anna", "ben", "cleo"),
        ("10.10", "10.14", "10.18", "10.30"),  # times
        ("frame1",),
        (),
    ],
)
def test_names_without_a_row_of_numbers_have_no_jumps(stems):
    assert jumps(named(*stems)) == []


@given(st.integers(0, 50), st.integers(1, 9), st.integers(5, 40), st.data())
def test_what_is_taken_from_a_row_is_found(start, step, count, data):
    gone = data.draw(st.integers(1, count - 2))
    row = [start + step * index for index in range(count)]
    left = named(*(f"cam2_{number:04d}_grey" for number in row if number != row[gone]))
    assert jumps(left) == [(row[gone - 1], row[gone + 1])]


def test_the_thermal_pictures_of_a_runs_folder_are_found_with_their_truth(tmp_path):
    write_folder(tmp_path / "run" / "thermal", 3)
    write_folder(tmp_path / "run" / "colour", 3, "jpg")
    (tmp_path / "run" / "truth").mkdir()
    (tmp_path / "run" / "truth" / "gt.txt").write_text("1,1,39.0,23.0,22.0,74.0,1,1,1.0\n")
    Image.new("RGB", (400, 300)).save(tmp_path / "run" / "contact_sheet.png")
    (tmp_path / "run" / "run.json").write_text("{}")
    footage = open_footage(tmp_path / "run")
    assert (footage.name, footage.expected) == ("run", 3)
    assert next(iter(footage)).shape == (120, 160)
    assert "HOTA" in call(tmp_path / "run", "--out", tmp_path / "out").stdout


def test_the_contact_sheet_of_a_run_without_frames_is_no_footage(tmp_path):
    call(write_folder(tmp_path / "clip", 3), "--out", tmp_path / "run")
    assert_names(refusal(tmp_path / "run", "--out", tmp_path / "out"), tmp_path / "run", "thermal")


def test_a_folder_without_pictures_names_one_inside_that_has_some(tmp_path):
    write_folder(tmp_path / "run" / "thermal16", 12)
    told = refusal(tmp_path / "run", "--out", tmp_path / "out")
    assert_names(told, tmp_path / "run", "thermal16/", "12")


def test_empty_and_damaged_pictures_are_named_once_with_advice(tmp_path):
    clip = write_folder(tmp_path / "clip", 3)
    broken = clip / "frame2.png"
    for content, reason in ((b"", "empty"), (b"no picture", "PNG")):
        broken.write_bytes(content)
        told = refusal(clip, "--out", tmp_path / "out")
        assert_names(told, broken, reason, "remove it")
        assert told.count("frame2") == 1


def test_grey_with_opacity_is_said_to_have_opacity(tmp_path):
    clip = tmp_path / "clip"
    clip.mkdir()
    Image.fromarray(np.dstack([walker(0), np.full_like(walker(0), 255)])).save(clip / "0.png")
    result = call(clip, "--out", tmp_path / "out")
    assert_names(result.stderr, "note: ", "opacity")
    assert "fourth" not in result.stderr


def test_equal_channels_of_16_bits_are_read_as_counts_and_others_as_8_bits(tmp_path):
    counts = np.where(walker(0) > 100, 30415, 29315).astype(np.uint16)
    equal, colours = (tmp_path / f"{name}.png" for name in ("equal", "colours"))
    cv2.imwrite(str(equal), np.dstack([counts] * 3))
    cv2.imwrite(str(colours), np.dstack([counts, counts, counts // 2]))
    notes = []
    np.testing.assert_array_equal(read_picture(equal, notes), counts)
    assert notes == []
    assert read_picture(colours, notes).dtype == np.uint8
    assert "of which 8 are read" in notes[0]


def test_counts_with_exchanged_bytes_are_noticed():
    noise = np.random.default_rng(0).integers(0, 30, walker(0).shape)
    counts = np.where(walker(0) > 100, 30415, 29315).astype(np.uint16) + noise.astype(np.uint16)
    assert are_bytes_swapped(counts.byteswap())
    for sound in (counts, counts >> 8, counts << 8, np.zeros_like(counts), walker(0)):
        assert not are_bytes_swapped(sound)


def test_tiffs_of_floats_of_64_bits_and_of_signed_counts_are_read(tmp_path):
    picture = np.linspace(-20.5, 40.25, 60 * 80).reshape(60, 80)
    cv2.imwrite(str(tmp_path / "a.tif"), picture)
    found = read_picture(tmp_path / "a.tif", [])
    assert found.dtype == np.float32
    assert found == pytest.approx(picture.astype(np.float32))
    for low, dtype in ((0, np.uint16), (-500, np.float32)):
        counts = np.arange(low, low + 4800, dtype=np.int16).reshape(60, 80)
        cv2.imwrite(str(tmp_path / "b.tif"), counts)
        found = read_picture(tmp_path / "b.tif", [])
        assert (found.dtype, found.tolist()) == (dtype, counts.tolist())
    cv2.imwritemulti(str(tmp_path / "c.tif"), [picture, picture + 1.0])
    assert [page[0, 0] for page in open_footage(tmp_path / "c.tif")] == [-20.5, -19.5]


@pytest.mark.parametrize("packing", [1, 8])
def test_a_tiff_of_floats_of_16_bits_is_read(tmp_path, packing):
    picture = np.linspace(10.0, 40.0, 6 * 8).reshape(6, 8).astype("<f2")
    data = zlib.compress(picture.tobytes()) if packing == 8 else picture.tobytes()
    tags = TiffImagePlugin.ImageFileDirectory_v2()
    for tag, value in {256: 8, 257: 6, 258: 16, 259: packing, 262: 1, 277: 1, 278: 6, 339: 3}.items():
        tags[tag] = value
    tags[279] = len(data)
    tags[273] = 0  # from the end of the tags, where the library moves it
    header = b"II*\0\x08\0\0\0" + tags.tobytes(8)
    (tmp_path / "half.tif").write_bytes(header + data)
    found = read_picture(tmp_path / "half.tif", [])
    assert found.dtype == np.float32
    assert found == pytest.approx(picture.astype(np.float32))


@pytest.mark.parametrize("suffix", ["png", "tif"])
def test_three_equal_channels_of_16_bits_are_counts_and_others_lose_bits_with_a_note(tmp_path, suffix):
    counts = np.arange(29000, 29000 + 48, dtype=np.uint16).reshape(6, 8)
    path = tmp_path / f"deep.{suffix}"
    cv2.imwrite(str(path), np.dstack([counts] * 3))
    notes: list[str] = []
    assert read_picture(path, notes).tolist() == counts.tolist()
    assert not notes
    cv2.imwrite(str(path), np.dstack([counts, counts, counts + 9]))
    assert read_picture(path, notes).dtype == np.uint8
    assert_names(notes[0], "16 bits", "8 are read")


@pytest.mark.parametrize("suffix", ["jpg", "png", "tif"])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_pictures_are_turned_as_their_exif_orientation_says(tmp_path, suffix, orientation):
    upright = np.zeros((40, 64), np.uint8)
    upright[:8, :24] = 250  # the upper left corner
    stored = {
        1: upright,
        2: upright[:, ::-1],
        3: upright[::-1, ::-1],
        4: upright[::-1],
        5: upright.T,
        6: np.rot90(upright, 1),
        7: np.rot90(upright, 2).T,
        8: np.rot90(upright, -1),
    }[orientation]
    exif = Image.Exif()
    exif[0x0112] = orientation
    path = tmp_path / f"turned.{suffix}"
    Image.fromarray(np.ascontiguousarray(stored)).save(path, exif=exif)
    found = read_picture(path, [])
    assert found.shape == upright.shape
    assert np.abs(found.astype(int) - upright).mean() < 3.0


def test_the_times_in_names_are_those_of_the_pictures(tmp_path):
    for time in (1700000000.0, 1700000000.066667, 1700000000.4, 1700000000.466667):
        cv2.imwrite(str(tmp_path / f"{time:.6f}.png"), np.zeros((6, 8), np.uint8))
    footage = open_footage(tmp_path)
    assert footage.times_s == pytest.approx([0.0, 0.066667, 0.4, 0.466667], abs=1e-6)
    assert footage.rate_hz == pytest.approx(15.0, abs=0.01)


def test_names_that_count_by_twos_are_noted(tmp_path):
    for number in (2, 4, 6, 8):
        cv2.imwrite(str(tmp_path / f"{number:04}.png"), np.zeros((6, 8), np.uint8))
    assert_names(open_footage(tmp_path).notes[0], "count by 2")


def test_a_folder_with_colour_and_infrared_pictures_is_refused_with_both(tmp_path):
    write_folder(tmp_path / "clip" / "color", 3)
    write_folder(tmp_path / "clip" / "ir", 3)
    with refused("clip", "color/", "ir/"):
        open_footage(tmp_path / "clip")


def test_a_video_with_uneven_times_is_not_taken_for_a_damaged_one(tmp_path):
    av = pytest.importorskip("av")
    with av.open(str(tmp_path / "uneven.mkv"), "w") as film:
        stream = film.add_stream("ffv1", rate=30)
        stream.width, stream.height, stream.pix_fmt = 32, 24, "gray"
        for time in (0, 2, 4, 5, 17, 19, 20):
            frame = av.VideoFrame.from_ndarray(np.full((24, 32), 29, np.uint8), format="gray")
            frame.pts = time
            film.mux(stream.encode(frame))
        film.mux(stream.encode())
    footage = open_footage(tmp_path / "uneven.mkv")
    assert len(list(footage)) == 7
    assert_names(footage.notes[-1], "7 pictures at uneven times", "--rate-hz 9")
    assert footage.times_s == pytest.approx(np.array([0, 2, 4, 5, 17, 19, 20]) / 30, abs=1e-3)


def test_a_video_whose_size_changes_is_noted(tmp_path):
    av = pytest.importorskip("av")
    parts = []
    for width, height in ((64, 48), (32, 24)):
        with av.open(str(tmp_path / "part.ts"), "w", format="mpegts") as film:
            stream = film.add_stream("mpeg2video", rate=15)
            stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
            for level in range(24):
                picture = np.full((height, width, 3), 10 * level, np.uint8)
                film.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
            film.mux(stream.encode())
        parts.append((tmp_path / "part.ts").read_bytes())
    (tmp_path / "both.ts").write_bytes(b"".join(parts))
    footage = open_footage(tmp_path / "both.ts")
    assert {picture.shape for picture in footage} == {(48, 64, 3)}
    assert any("64x48, 32x24" in note for note in footage.notes)
    (tmp_path / "one.ts").write_bytes(parts[0])
    single = open_footage(tmp_path / "one.ts")
    list(single)
    assert not [note for note in single.notes if "change size" in note]


def test_a_folder_that_vanishes_is_refused(tmp_path):
    with refused(tmp_path / "gone"):
        pictures_in(tmp_path / "gone")


@pytest.mark.parametrize("what", ["footage", "--colour", "--truth"])
def test_a_run_that_holds_what_is_to_be_read_is_not_replaced(tmp_path, what):
    run, apart = tmp_path / "run", write_folder(tmp_path / "clip", 3)
    clip = write_folder(run / "thermal", 3)
    (run / "run.json").write_text("{}")
    (clip / "groundtruth.txt").write_text("39,23,22,74\n" * 3)
    more = {"--colour": (apart, "--colour", clip), "--truth": (apart, "--truth", clip / "groundtruth.txt")}
    told = refusal(*more.get(what, (clip,)), "--out", run, "--overwrite")
    assert_names(told, f"{run}: ", clip)
    assert len(list(clip.iterdir())) == 4


def test_a_text_and_a_single_picture_are_no_video(tmp_path):
    (tmp_path / "tracks.txt").write_text("1,1,20.0,30.0,10.0,40.0,1,-1,-1,-1\n" * 40)  # FFmpeg would draw it
    with refused("tracks.txt", "cannot be read as a video"):
        open_footage(tmp_path / "tracks.txt")
    clip = write_folder(tmp_path / "clip", 1)
    with refused("frame1.png", "is one picture", "folder"):
        open_footage(clip / "frame1.png")


def test_a_video_of_16_bits_is_said_to_be_read_as_one_of_8(tmp_path):
    av = pytest.importorskip("av")
    with av.open(str(tmp_path / "deep.mkv"), "w") as film:
        stream = film.add_stream("ffv1", rate=9)
        stream.width, stream.height, stream.pix_fmt = 32, 24, "gray16le"
        frame = av.VideoFrame.from_ndarray(np.full((24, 32), 29000, np.uint16), format="gray16le")
        film.mux([*stream.encode(frame), *stream.encode()])
    (note,) = open_footage(tmp_path / "deep.mkv").notes
    assert_names(note, "deep.mkv", "16 bits", "8 are read", "%06d.tiff")
