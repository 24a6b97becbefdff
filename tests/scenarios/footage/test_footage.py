import json
import os
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner
from PIL import Image

from peopleboy.scenarios.commands.inspect_commands import evaluate
from peopleboy.scenarios.footage.detect_polarity import detect_polarity
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.track_footage import pictures_a_second, track_footage
from peopleboy.tracker.evaluation.table import NEED_EVERYBODY
from peopleboy.tracker.footage.box_kinds import TORSO_PER_HEIGHT, WHOLE_PER_HEIGHT, BoxKind
from peopleboy.tracker.footage.footage_truth import find_truth, load_truth
from peopleboy.tracker.footage.grey import AutomaticGrey, Polarity, Radiometry, grey_maker, parse_scale
from peopleboy.tracker.footage.image_sequences import open_footage
from peopleboy.tracker.footage.picture_names import natural_order
from tests.helpers.calls.footage_calls import call, refusal
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.images.footage_files import SIZE, box, walker, write_counts, write_folder, write_video

REAL_CLIP = os.environ.get("PEOPLEBOY_REAL_CLIP", "")


def quietly(options):
    return track_footage(options, lambda *_: None)


def otb(folder, count=12, name="groundtruth_rect.txt"):
    lines = [",".join(str(edge) for edge in box(frame)) for frame in range(count)]
    (folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")


def test_names_sort_as_people_count():
    assert sorted(["b2", "a10", "a9", "a"], key=natural_order) == ["a", "a9", "a10", "b2"]


@pytest.mark.parametrize("suffix", ["png", "bmp", "tif", "jpg"])
def test_pictures_of_every_kind_are_read_in_natural_order(tmp_path, suffix):
    footage = open_footage(write_folder(tmp_path / "clip", suffix=suffix))
    for frame, picture in enumerate(footage):
        assert np.abs(picture.astype(int) - walker(frame)).mean() < 2
    assert footage.expected == 12


def test_a_video_gives_its_pictures_and_its_rate(tmp_path):
    video = open_footage(write_video(tmp_path / "clip.mkv"))
    assert (video.rate_hz, video.expected, video.name) == (25.0, 12, "clip")
    assert all(np.abs(picture[..., 0].astype(int) - walker(i)).max() < 3 for i, picture in enumerate(video))


def test_a_started_person_is_tracked_and_the_folder_is_like_that_of_a_run(tmp_path):
    clip = write_folder(tmp_path / "clip")
    otb(clip)
    tracked = quietly(TrackOptions(footage=clip, out=tmp_path / "out", start="truth"))
    assert tracked.scores.mot.identity.idr > 90
    out = tmp_path / "out"
    assert {path.name for path in out.iterdir()} == {
        *("tracks.txt", "tracks.parquet", "run.json", "contact_sheet.png", "metrics.json", "truth"),
        "latency.txt",
    }
    about = json.loads((out / "run.json").read_text())
    assert (about["status"], about["frames"], about["width"]) == ("complete", 12, 160)
    assert pq.read_table(out / "tracks.parquet").num_rows >= len((out / "tracks.txt").read_text().split())
    assert cv2.imread(str(out / "contact_sheet.png")).shape[1] > 1600


@pytest.mark.parametrize("kind", BoxKind)
def test_people_are_boxed_as_the_truth_boxes_them(tmp_path, kind):
    clip = write_folder(tmp_path / "clip")
    wide = 0.0 if kind is BoxKind.TORSO else 6.0
    boxes = [
        (left - wide / 2.0, top, width + wide, height) for left, top, width, height in map(box, range(12))
    ]
    text = "\n".join(",".join(map(str, one)) for one in boxes)
    (clip / "groundtruth_rect.txt").write_text(text + "\n", encoding="utf-8")
    out, other = tmp_path / "out", tmp_path / "other"
    options = TrackOptions(footage=clip, out=out, start="truth", tracker="contour")
    tracked = quietly(options)
    assert json.loads((out / "run.json").read_text())["boxes"] == tracked.boxes == kind
    ratio = {BoxKind.TORSO: TORSO_PER_HEIGHT, BoxKind.WHOLE: WHOLE_PER_HEIGHT}[kind]
    assert first_ratio(out) == pytest.approx(ratio, abs=0.08)
    (opposite,) = set(BoxKind) - {kind}
    quietly(replace(options, out=other, boxes=opposite))
    assert (first_ratio(other) > first_ratio(out)) == (opposite is BoxKind.WHOLE)


def first_ratio(folder):
    _, _, _, _, width, height, *_ = (folder / "tracks.txt").read_text().split()[0].split(",")
    return float(width) / float(height)


def test_boxes_are_in_pixels_of_the_footage_whatever_its_size(tmp_path):
    for size, factor in ((SIZE, 1), ((360, 480), 3)):
        clip = write_folder(tmp_path / f"clip{factor}", size=size)
        start = tuple(factor * edge for edge in box(0))
        out = tmp_path / f"out{factor}"
        quietly(TrackOptions(footage=clip, out=out, start=start, boxes=BoxKind.TORSO))
        last = np.array((out / "tracks.txt").read_text().split()[-1].split(",")[2:6], float) / factor
        np.testing.assert_allclose(last[:2], box(11)[:2], atol=5)


def test_the_same_seed_gives_the_same_bytes(tmp_path):
    clip = write_folder(tmp_path / "clip")
    for name in ("a", "b"):
        quietly(TrackOptions(footage=clip, out=tmp_path / name, start=box(0), seed=4))
    for name in ("tracks.txt", "tracks.parquet", "contact_sheet.png", "run.json"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_counts_in_centikelvin_become_the_grey_of_the_robots_camera(tmp_path):
    clip = write_counts(tmp_path / "clip")
    picture = next(iter(open_footage(clip)))
    values = Radiometry(scale=parse_scale("centikelvin")).values(picture)
    assert sorted(np.unique(values.round(2))) == pytest.approx([20.0, 31.0], abs=0.01)


def test_sixteen_bits_without_scale_fall_back_to_the_scenes_contrast_and_say_so(tmp_path):
    result = call(write_counts(tmp_path / "clip"), "--out", tmp_path / "out")
    assert result.exit_code == 0
    assert "without --scale" in result.stderr


def test_black_hot_footage_turned_round_is_the_same_as_white_hot():
    grey, inverted = walker(3), 255 - walker(3)
    np.testing.assert_array_equal(
        Radiometry().values(grey), Radiometry(polarity=Polarity.BLACK_HOT).values(inverted)
    )


def test_automatic_grey_does_not_depend_on_the_unit():
    values = np.random.default_rng(0).normal(20.0, 3.0, (60, 80)).astype(np.float32)
    one, other = AutomaticGrey()(values), AutomaticGrey()(values * 100 + 27315)
    assert np.abs(one.astype(int) - other).max() <= 1


def test_automatic_grey_does_not_blow_up_noise():
    noise = np.random.default_rng(0).normal(20.0, 0.05, (60, 80)).astype(np.float32)
    assert AutomaticGrey()(noise).std() < 10


def test_pictures_of_eight_bits_are_taken_as_they_are_by_the_tracker_of_footage_whatever_greys_mean():
    grey = walker(3)
    for radiometry in (Radiometry(), Radiometry(span_c=(-7.3, 41.1))):
        to_grey = grey_maker(radiometry, is_grey=True, by_contrast=True)
        np.testing.assert_array_equal(to_grey(radiometry.values(grey)), grey)


def test_four_channels_lose_the_fourth_and_say_so(tmp_path):
    clip = tmp_path / "clip"
    clip.mkdir()
    for frame in range(3):
        cv2.imwrite(str(clip / f"{frame}.png"), cv2.cvtColor(walker(frame), cv2.COLOR_GRAY2BGRA))
    result = call(clip, "--out", tmp_path / "out")
    assert result.exit_code == 0
    assert "opacity" in result.stderr


def test_colour_goes_along_and_what_has_none_is_left_out(tmp_path):
    clip, colour = write_folder(tmp_path / "clip"), write_folder(tmp_path / "colour", 12, "jpg")
    assert call(clip, "--out", tmp_path / "out", "--colour", colour).exit_code == 0
    (colour / "frame7.jpg").unlink()
    (clip / "frame3.png").unlink()
    result = call(clip, "--out", tmp_path / "some", "--colour", colour)
    assert "10 frames" in result.stdout
    assert_names(result.stderr.replace("\n", " "), "frame7.png: has no colour picture")
    for number in range(1, 13):
        (colour / f"frame{number}.jpg").unlink(missing_ok=True)
        cv2.imwrite(str(colour / f"{5 * number * number}.jpg"), walker(number))
    (colour / "5.jpg").unlink()
    assert_names(refusal(clip, "--out", tmp_path / "none", "--colour", colour), colour, "same numbers")


def times_of(folder):
    table = pq.read_table(folder / "tracks.parquet")
    return dict(zip(table["frame"].to_pylist(), table["time_s"].to_pylist(), strict=True))


def test_times_come_from_a_file_or_from_gaps_in_the_numbers(tmp_path):
    clip = write_folder(tmp_path / "clip")
    stamps = tmp_path / "times.txt"
    stamps.write_text(
        "# time name\n" + "".join(f"{10 + 0.1 * k**1.1:.4f} frame{k}.png\n" for k in range(1, 13))
    )
    result = call(clip, "--out", tmp_path / "out", "--timestamps", stamps, "--start", "30,30,20,60")
    assert result.exit_code == 0, result.stderr
    assert times_of(tmp_path / "out")[12] == pytest.approx(0.1 * (12**1.1 - 1), abs=1e-3)
    assert_names(
        refusal(clip, "--out", tmp_path / "no", "--timestamps", stamps, "--rate-hz", 5), "--timestamps"
    )
    stamps.write_text("1\n2\n3\n")
    assert_names(refusal(clip, "--out", tmp_path / "no", "--timestamps", stamps), stamps, "12", "got 3")
    for number in (5, 6, 7):
        (clip / f"frame{number}.png").unlink()
    result = call(clip, "--out", tmp_path / "gaps", "--rate-hz", 10, "--start", "30,30,20,60")
    assert_names(result.stderr.replace("\n", " "), "jump from 4 to 8", "their times have them")
    assert times_of(tmp_path / "gaps")[5] == pytest.approx(0.7)


def test_pictures_of_mixed_sizes_are_refused_by_name(tmp_path):
    clip = write_folder(tmp_path / "clip")
    cv2.imwrite(str(clip / "frame7.png"), walker(0, (60, 80)))
    assert_names(refusal(clip, "--out", tmp_path / "out"), clip / "frame7.png", "160x120")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["clip"]


@pytest.mark.parametrize("suffix", ["png", "jpg", "bmp"])
def test_a_truncated_picture_is_refused_by_name(tmp_path, suffix):
    clip = write_folder(tmp_path / "clip", suffix=suffix)
    broken = clip / f"frame3.{suffix}"
    broken.write_bytes(broken.read_bytes()[: broken.stat().st_size // 2])
    assert_names(refusal(clip, "--out", tmp_path / "out"), broken)


def test_pixels_that_are_no_numbers_are_refused(tmp_path):
    clip = tmp_path / "clip"
    clip.mkdir()
    picture = walker(0).astype(np.float32)
    picture[5, 5] = np.nan
    Image.fromarray(picture).save(clip / "0.tiff")
    assert_names(refusal(clip, "--out", tmp_path / "out"), clip / "0.tiff", "1 pixel")


def test_an_empty_folder_a_missing_one_and_a_video_without_codec_are_refused(tmp_path):
    (tmp_path / "empty").mkdir()
    (tmp_path / "clip.mp4").write_bytes(bytes(2000))
    for name in ("empty", "missing", "clip.mp4"):
        assert_names(refusal(tmp_path / name, "--out", tmp_path / "out"), tmp_path / name)
    assert not (tmp_path / "out").exists()


def test_a_truncated_video_is_tracked_as_far_as_it_goes_and_says_so(tmp_path):
    video = write_video(tmp_path / "clip.avi", 40)
    video.write_bytes(video.read_bytes()[: video.stat().st_size // 2])
    footage = open_footage(video)
    count = len(list(footage))
    assert 0 < count < 40
    assert count == footage.expected or footage.notes


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (("--temperature-range", 30, 20), ("LOW < HIGH",)),
        (("--temperature-range", 20, 30, "--scale", "centikelvin"), ("--scale",)),
        (("--scale", "kelvin"), ("'centikelvin'", "GAIN,OFFSET")),
        (("--scale", "0.01,-273.15"), ("16-bit",)),
        (("--start", "1,2,3"), ("X,Y,W,H",)),
        (("--start", "truth"), ("clip", "truth")),
        (("--tracker", "best"), ("'best'", "contour")),
        (("--tracker", "mine:Mine", "--boxes", "whole"), ("--boxes whole", "leave it out")),
    ],
)
def test_options_that_cannot_be_are_refused(tmp_path, options, named):
    printed = refusal(write_folder(tmp_path / "clip"), "--out", tmp_path / "out", *options)
    assert_names(printed, *named)
    assert not (tmp_path / "out").exists()


def test_truth_is_read_as_boxes_polygons_and_motchallenge(tmp_path):
    boxes = tmp_path / "otb.txt"
    boxes.write_text("1,2,3,4\n5\t6\t7\t8\nnan,nan,nan,nan\n")
    given = load_truth(boxes, 3)
    assert given.truth.box.tolist() == [[1, 2, 3, 4], [5, 6, 7, 8]]
    assert given.is_single
    polygon = tmp_path / "vot.txt"
    polygon.write_text("1,2,4,2,4,6,1,6\n")
    assert load_truth(polygon, 1).truth.box.tolist() == [[1, 2, 3, 4]]
    mot = tmp_path / "gt.txt"
    mot.write_text("1,3,1.00,2.00,3.00,4.00,1,1,1.0000\n")
    assert not load_truth(mot, 5).is_single
    mot.write_text("")
    assert not load_truth(mot, 5).is_single
    mot.write_text("1,3,1.00,2.00,3.00\n")
    with refused(f"{mot}:1: ", "6 to 10 numbers"):
        load_truth(mot, 5)


def test_of_one_annotated_person_only_what_it_can_tell_is_scored_at_once_and_later(tmp_path):
    clip, out = write_folder(tmp_path / "clip"), tmp_path / "out"
    otb(clip)
    printed = call(clip, "--out", out, "--start", "truth").stdout
    again = CliRunner().invoke(evaluate, [str(out)]).stdout
    files = ("--truth", str(clip / "groundtruth_rect.txt"), "--tracks", str(out / "tracks.txt"))
    assert again == CliRunner().invoke(evaluate, files).stdout
    assert printed.startswith(again)
    table, _, unknown = again.partition("Unknown: ")
    names = {line.split()[0] for line in table.splitlines() if line.strip()}
    assert {"CR", "AR", "MOTP", "IDR", "IDSW", "true_tracks"} <= names
    assert not names & NEED_EVERYBODY
    assert "One id is on the annotated person" in again
    assert unknown.startswith("CP, CA, AP, AA,")
    assert (out / "truth" / "groundtruth.txt").read_bytes() == (clip / "groundtruth_rect.txt").read_bytes()
    stored = json.loads((out / "metrics.json").read_text())
    assert (
        stored["thesis"]["CP_percent"]
        is stored["mot"]["MOTA_percent"]
        is stored["counts"]["false_tracks"]
        is None
    )
    assert stored["mot"]["IDR_percent"] > 90


def test_footage_without_truth_is_not_scored(tmp_path):
    assert call(write_folder(tmp_path / "clip"), "--out", tmp_path / "out").exit_code == 0
    result = CliRunner().invoke(evaluate, [str(tmp_path / "out")])
    assert_names(str(result.exception), tmp_path / "out", "truth")


def test_truth_of_several_people_gives_every_figure(tmp_path):
    clip = write_folder(tmp_path / "clip")
    (clip / "gt").mkdir()
    lines = [f"{i + 1},7,{','.join(str(edge) for edge in box(i))},1,1,1.0\n" for i in range(12)]
    (clip / "gt" / "gt.txt").write_text("".join(lines))
    result = call(clip, "--out", tmp_path / "out", "--start", "truth")
    assert "HOTA" in result.stdout
    assert "frames/s" in result.stdout
    assert (tmp_path / "out" / "truth" / "gt.txt").is_file()


def test_truth_is_found_beside_and_above_the_pictures(tmp_path):
    clip = write_folder(tmp_path / "clip" / "img", 3)
    otb(tmp_path / "clip", 3)
    assert find_truth(clip) == find_truth(tmp_path / "clip") == Path(tmp_path / "clip/groundtruth_rect.txt")


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("1,2,3,4\n", ("12", "got 1")),
        ("1,2,x,4\n" * 12, (":1: ", "numbers")),
        ("1,2,3\n" * 12, (":1: ", "x,y,w,h", "polygon", "got 3")),
        ("13,1,1.0,2.0,3.0,4.0,1,1,1.0\n", ("frame 12",)),
    ],
)
def test_truth_that_does_not_belong_to_the_pictures_is_refused(tmp_path, text, named):
    clip, truth = write_folder(tmp_path / "clip"), tmp_path / "truth.txt"
    truth.write_text(text)
    assert_names(refusal(clip, "--out", tmp_path / "out", "--truth", truth), truth, *named)


@pytest.mark.skipif(not REAL_CLIP, reason="PEOPLEBOY_REAL_CLIP names no folder")
def test_the_person_of_a_real_clip_is_kept_for_most_of_it(tmp_path):
    shares = [
        quietly(
            TrackOptions(footage=Path(REAL_CLIP), out=tmp_path / str(seed), seed=seed)
        ).scores.mot.identity.idr
        for seed in range(5)
    ]
    assert np.mean(shares) > 85


def test_speed_is_that_of_pictures_for_which_nothing_is_compiled() -> None:
    done = 20.0 + 0.1 * np.arange(10)
    assert pictures_a_second([0.0, *done]) == pytest.approx(10.0)
    assert pictures_a_second([0.0, 20.0, 20.5]) == pytest.approx(2.0)
    assert pictures_a_second([0.0, 20.0]) == pytest.approx(0.05)  # there is no other


def test_black_hot_images_are_detected_and_tracked_like_white_hot_ones(tmp_path):
    write_folder(tmp_path / "white", 16)
    (tmp_path / "black").mkdir()
    for number in range(16):
        cv2.imwrite(str(tmp_path / "black" / f"frame{number + 1}.png"), 255 - walker(number))
    printed = {}
    for name in ("white", "black"):
        result = call(tmp_path / name, "--out", tmp_path / f"{name}-out")
        printed[name] = result.stderr
        assert result.exit_code == 0
    assert "dark pixels are taken as warm" in printed["black"]
    assert "dark pixels" not in printed["white"]
    tracks = [(tmp_path / f"{name}-out" / "tracks.txt").read_text() for name in printed]
    assert tracks[0] == tracks[1] != ""
    given = call(tmp_path / "black", "--out", tmp_path / "given", "--polarity", "white-hot")
    assert "dark pixels" not in given.stderr


def test_the_polarity_of_images_without_people_is_unknown():
    assert detect_polarity([np.full((120, 160), 60, np.uint8)] * 3) is None
