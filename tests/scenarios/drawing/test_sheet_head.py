import numpy as np
from PIL import Image, ImageDraw

from peopleboy.scenarios.drawing.palette import TRUTH, track_colour
from peopleboy.scenarios.drawing.sheet_head import HEAD_PX, MARGIN_PX, PAGE, STRONG, cut, draw_head, font
from tests.helpers.calls.footage_calls import call
from tests.helpers.images.footage_files import box, write_folder


def head(title="clip", length="12 frames", **options):
    page = Image.new("RGB", (1600, 200), PAGE)
    draw_head(page, title, length, **options)
    return np.array(page)


def has(page, colour):
    return bool((page == colour).all(axis=2).any())


def test_the_head_keeps_to_its_rows_and_explains_truth_only_where_it_is_drawn():
    for has_truth in (True, False):
        page = head(has_truth=has_truth)
        assert (page[HEAD_PX:] == PAGE).all()
        assert has(page, STRONG)
        assert has(page, track_colour(1))
        assert has(page, TRUTH) == has_truth


def test_a_long_title_is_cut_and_runs_into_nothing():
    columns = np.flatnonzero((head(title="a long name " * 30) == STRONG).all(axis=2).any(axis=0))
    legend = np.flatnonzero((head() == track_colour(1)).all(axis=2).any(axis=0))
    assert columns[0] >= MARGIN_PX
    assert columns[-1] < legend[0]
    draw = ImageDraw.Draw(Image.new("RGB", (1, 1)))
    assert cut(draw, "short", font(15), 500) == "short"


def test_the_sheet_of_footage_says_whose_it_is_and_what_its_marks_mean(tmp_path):
    heads = []
    for name in ("one", "other"):
        clip = write_folder(tmp_path / name, 3)
        start = ",".join(str(edge) for edge in box(0))
        assert call(clip, "--out", tmp_path / f"{name}_out", "--start", start).exit_code == 0
        sheet = np.array(Image.open(tmp_path / f"{name}_out" / "contact_sheet.png").convert("RGB"))
        heads.append(sheet[:HEAD_PX])
        assert has(heads[-1], STRONG)
        assert has(heads[-1], track_colour(1))
        assert not has(heads[-1], TRUTH)
    assert not np.array_equal(*heads)
