from pathlib import Path

import cv2
import pytest

from peopleboy.tracker.footage.image_sequences import open_footage
from peopleboy.tracker.footage.picture_names import split_sequence
from tests.helpers.calls.footage_calls import call, refusal
from tests.helpers.calls.refused import assert_names
from tests.helpers.images.footage_files import walker, write_folder


def named(*stems):
    return [Path(f"{stem}.png") for stem in stems]


def row(pattern, count, first=1):
    return named(*(pattern.format(number) for number in range(first, first + count)))


def test_a_mask_beside_the_pictures_is_left_out_and_it_is_said(tmp_path):
    clip = write_folder(tmp_path / "clip", 4)
    cv2.imwrite(str(clip / "mask.png"), walker(0))
    result = call(clip, "--out", tmp_path / "out")
    assert "4 frames" in result.stdout
    assert_names(result.stderr, "note: ", clip / "mask.png", "left out", "frame1.png")


@pytest.mark.parametrize(
    ("paths", "others"),
    [
        (row("{:06d}", 60) + named("mask"), ["mask"]),
        (row("frame{}", 3) + named("cover"), ["cover"]),
        (row("a{}_t", 40) + named("b1_t", "mean", "mask2"), ["b1_t", "mean", "mask2"]),
    ],
)
def test_few_others_are_left_out(paths, others):
    film, left_out = split_sequence(paths)
    assert [path.stem for path in left_out] == others
    assert film == paths[: -len(others)]


@pytest.mark.parametrize(
    "paths",
    [
        [],
        named("anna", "ben", "cleo", "dora"),
        named("mask"),
        row("{}", 2) + named("mask"),  # too few to tell
        row("seq1_f{}", 9) + row("seq2_f{}", 9),
        row("left{}", 9) + row("right{}", 9, first=10),  # one after the other
        named("1a", "2b", "3c", "1d", "2e", "3f"),
    ],
)
def test_names_without_one_pattern_are_all_a_film(paths):
    assert split_sequence(paths) == (paths, [])


@pytest.mark.parametrize("other", ["right{}", "left{}_mask"])
def test_pictures_of_two_cameras_or_with_masks_are_refused(tmp_path, other):
    clip = tmp_path / "clip"
    clip.mkdir()
    for frame in range(4):
        for pattern in ("left{}", other):
            cv2.imwrite(str(clip / f"{pattern.format(frame)}.png"), walker(frame))
    told = refusal(clip, "--out", tmp_path / "out")
    assert_names(told, clip, "left0.png", f"{other.format(0)}.png", "folder of its own")


def test_what_is_left_out_leaves_no_hole_in_the_numbers(tmp_path):
    clip = write_folder(tmp_path / "clip", 5)
    cv2.imwrite(str(clip / "frame.png"), walker(0))
    assert open_footage(clip).numbers == range(1, 6)
