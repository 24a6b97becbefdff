from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.scenarios.drawing.overlay import (
    PALETTES,
    Plate,
    draw_line,
    draw_tracks,
    draw_truth,
    encode_jpeg,
    enlarge,
    lines_of,
    map_box,
    show_thermal,
)
from peopleboy.scenarios.drawing.palette import TRUTH, track_colour
from peopleboy.tracker.reproductions.contour.measurement.section_evidence import outline
from peopleboy.tracker.track import Status
from tests.helpers.runs import synthetic_ticks as made

GREY = np.full((480, 640, 3), 60, np.uint8)


def is_coloured(
    picture: NDArray[np.uint8], points: NDArray[np.float64], colour: tuple[int, int, int]
) -> bool:
    """Whether within a pixel of every point of the enlarged picture there is one of about this colour."""
    near = np.abs(picture.astype(int) - colour).max(axis=2) < 60
    grown = cv2.dilate(near.astype(np.uint8), np.ones((3, 3), np.uint8))
    columns, rows = np.rint(points * 2.0 + 0.5).astype(int).T
    return bool(grown[rows, columns].all())


def test_the_outline_of_a_track_has_its_colour_all_around() -> None:
    picture = draw_tracks(GREY, [made.TRACK], explanation=made.explain())
    for line in outline(made.ELLIPSE, 200):
        assert is_coloured(picture, line, track_colour(1))


def test_the_box_of_a_track_is_drawn_where_the_affine_puts_it() -> None:
    affine = np.array([[1.2, 0.0, -30.0], [0.0, 1.2, -20.0]])
    picture = draw_tracks(GREY, [made.TRACK], affine=affine)
    left, top, width, height = map_box(made.TRACK.boxes["thermal"], affine)
    corners = np.array([[left, top], [left + width, top], [left, top + 0.5 * height]])
    assert is_coloured(picture, corners, track_colour(1))


def test_nothing_is_drawn_far_from_a_track_and_the_picture_given_stays_as_it_is() -> None:
    before = GREY.copy()
    changed = (draw_tracks(GREY, [made.TRACK]) != GREY).any(axis=2)
    assert not changed[:, :250].any()
    assert not changed[:, 480:].any()
    assert np.array_equal(before, GREY)


def test_tracks_of_different_ids_have_different_colours() -> None:
    assert len({track_colour(number) for number in range(1, 7)}) == 6


def test_a_tentative_track_is_dim_and_its_short_label_is_a_question() -> None:
    sure, tentative = (draw_tracks(GREY, [made.with_status(s)]) for s in (Status.TRACKED, Status.TENTATIVE))
    outline_rows = slice(110, 430)  # below the labels
    assert tentative[outline_rows].max() < sure[outline_rows].max()
    label_rows = slice(0, 94)
    drawn = [(picture[label_rows] != GREY[label_rows]).any(axis=2).sum() for picture in (tentative, sure)]
    assert 0 < drawn[0] < drawn[1]


def test_labels_give_way_to_each_other() -> None:
    plates: list[Plate] = []
    people = [made.person(1, "anna", 4.0), made.person(2, "ben", 6.0)]
    draw_truth(draw_tracks(GREY, [made.TRACK] * 3, plates=plates), people, plates=plates)
    assert len(plates) == 5
    for one, other in combinations(plates, 2):
        assert one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


def test_truth_is_dashed_along_the_box() -> None:
    picture = draw_truth(GREY, [made.person(1, "anna", 4.0)])
    column = np.abs(picture[105:430, 280].astype(int) - TRUTH).max(axis=1) < 60
    assert 0.3 < column.mean() < 0.8


def test_truth_outside_the_image_is_left_out() -> None:
    away = replace(made.person(1, "anna", 4.0), box=(400.0, 50.0, 40.0, 170.0))
    behind = replace(away, box=None)
    assert np.array_equal(draw_truth(GREY, [away, behind]), GREY)


@pytest.mark.parametrize("box", [(-900.0, -900.0, 50.0, 60.0), (1e6, 0.0, 1e9, 10.0), (0.0, 0.0, 0.0, 0.0)])
def test_a_track_anywhere_can_be_drawn(box: tuple[float, float, float, float]) -> None:
    assert draw_tracks(GREY, [made.with_box(box)]).shape == GREY.shape


def test_lines_go_through_the_middles_of_enlarged_pixels() -> None:
    canvas = np.zeros((40, 40, 3), np.uint8)
    draw_line(canvas, np.array([[4.5, 2.0], [4.5, 8.0]]), (255, 255, 255), scale=3)
    # Between columns 4 and 5, enlarged three times, lies the edge of columns 14 and 15: 5 * 3 - 0.5.
    weight = canvas[15, :, 0].astype(float)
    assert weight @ np.arange(40) / weight.sum() == pytest.approx(14.5, abs=0.1)


def test_enlarging_keeps_every_pixel_in_its_place() -> None:
    image = np.zeros((5, 7, 3), np.uint8)
    image[2, 3] = 255
    large = enlarge(image, 4)[..., 0].astype(float)
    rows, columns = np.indices(large.shape)
    assert large.shape == (20, 28)
    assert (large * columns).sum() / large.sum() == pytest.approx((3 + 0.5) * 4 - 0.5, abs=0.01)
    assert (large * rows).sum() / large.sum() == pytest.approx((2 + 0.5) * 4 - 0.5, abs=0.01)


@pytest.mark.parametrize("palette", PALETTES)
def test_warmer_is_brighter_in_every_palette(palette: str) -> None:
    ramp = np.arange(256, dtype=np.uint8)[None]
    brightness = show_thermal(ramp, palette)[0].astype(float) @ (0.2126, 0.7152, 0.0722)
    assert np.all(np.diff(cv2.blur(brightness[None], (15, 1))[0][8:-8]) > 0)


def test_an_encoded_picture_has_its_colours_in_order() -> None:
    red = np.zeros((16, 16, 3), np.uint8)
    red[..., 0] = 250
    decoded = cv2.imdecode(np.frombuffer(encode_jpeg(red, 90), np.uint8), cv2.IMREAD_COLOR)
    assert decoded[8, 8].tolist() == pytest.approx([0, 0, 250], abs=6)


def test_contours_are_drawn_under_their_new_numbers() -> None:
    contours = made.explain()
    both = lines_of(contours.renumbered({1: 8}), 24)
    assert list(both) == [8]
    for one, other in zip(both[8], lines_of(contours, 24)[1], strict=True):
        assert one.shape[1] == 2
        assert (one == other).all()


def test_of_other_explanations_nothing_is_drawn() -> None:
    assert lines_of(None) == lines_of(object()) == {}
