import numpy as np
import pytest
from PIL import Image, TiffImagePlugin

from peopleboy.tracker.footage.image_sequences import open_footage
from tests.helpers.calls.footage_calls import call, refusal
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.images.footage_files import walker


def pages(count):
    return [Image.fromarray(100 * walker(frame).astype(np.uint16)) for frame in range(count)]


def saved(path, images, **more):
    path.parent.mkdir(exist_ok=True)
    images[0].save(path, save_all=True, append_images=images[1:], **more)
    return path


@pytest.mark.parametrize("is_folder", [True, False])
def test_the_pages_of_a_tiff_are_the_frames(tmp_path, is_folder):
    path = saved(tmp_path / "clip" / "film.tiff", pages(5))
    footage = open_footage(path.parent if is_folder else path)
    assert (footage.expected, footage.is_exact) == (5, True)
    assert footage.name == ("clip" if is_folder else "film")
    for _ in range(2):  # footage may be read again
        for frame, picture in enumerate(footage):
            np.testing.assert_array_equal(picture, 100 * walker(frame).astype(np.uint16))
        assert frame == 4


def test_truth_of_a_tiff_must_have_as_many_lines(tmp_path):
    path, truth = saved(tmp_path / "film.tif", pages(3)), tmp_path / "otb.txt"
    truth.write_text("39,23,22,74\n" * 4)
    told = refusal(path, "--out", tmp_path / "out", "--truth", truth)
    assert_names(told, truth, "3 pictures", "got 4")
    truth.write_text("39,23,22,74\n" * 3)
    assert "3 frames" in call(path, "--out", tmp_path / "out", "--truth", truth).stdout


def test_a_tiff_of_several_pages_among_other_pictures_is_refused(tmp_path):
    path = saved(tmp_path / "clip" / "1.tif", pages(2))
    saved(tmp_path / "clip" / "2.tif", pages(1))
    assert_names(refusal(tmp_path / "clip", "--out", tmp_path / "out"), path, "2 pages", "alone")


def test_a_smaller_copy_in_the_file_is_no_picture(tmp_path):
    path = tmp_path / "clip" / "1.tif"
    path.parent.mkdir()
    with TiffImagePlugin.AppendingTiffWriter(str(path), True) as file:
        for image, kind in ((pages(1)[0], 0), (pages(1)[0].resize((80, 60)), 1)):
            image.save(file, format="TIFF", tiffinfo={254: kind})
            file.newFrame()
    (picture,) = open_footage(path.parent)
    assert picture.shape == (120, 160)


def test_a_page_of_another_size_is_named(tmp_path):
    path = saved(tmp_path / "film.tif", [*pages(2), pages(1)[0].resize((80, 60))])
    with refused(f"{path}: page 3", "160x120", "80x60"):
        list(open_footage(path))


def test_a_damaged_tiff_is_refused_by_name(tmp_path):
    path = saved(tmp_path / "film.tif", pages(4))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert_names(refusal(path, "--out", tmp_path / "out"), path)
    path.write_bytes(b"no picture")
    assert_names(refusal(path, "--out", tmp_path / "out"), path, "TIF", "remove it")
