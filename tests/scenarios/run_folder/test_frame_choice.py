"""The frames of a data set are chosen alike by `render` and by `export`."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.frame_choice import (
    FrameChoice,
    FramePicker,
    VisiblePerson,
    chosen_frames,
)

FRAMES = range(1, 121)
ANNA, SLIVER = VisiblePerson(60.0, 0.9), VisiblePerson(4.0, 0.02)
EVERYWHERE = {frame: [ANNA] for frame in FRAMES}


def test_all_frames_are_chosen_by_default() -> None:
    assert FrameChoice().is_all
    assert chosen_frames(FrameChoice(), FRAMES, {}, 0) == tuple(FRAMES)


@given(st.integers(1, 130), st.integers(1, 130), st.integers(0, 50))
def test_each_part_of_a_run_gives_one_of_the_candidates(every: int, count: int, seed: int) -> None:
    choice = FrameChoice(every=every, frames_per_world=count)
    candidates = list(FRAMES[::every])
    found = chosen_frames(choice, FRAMES, EVERYWHERE, seed)
    assert len(found) == min(count, len(candidates))
    assert set(found) <= set(candidates)
    size = len(candidates) / len(found)
    assert all(k * size - 1 < candidates.index(frame) < (k + 1) * size + 1 for k, frame in enumerate(found))


@given(st.integers(0, 20))
def test_the_share_of_empty_frames_is_kept(seed: int) -> None:
    empty, half = dict[int, list[VisiblePerson]](), FrameChoice(keep_empty=0.5)
    assert chosen_frames(FrameChoice(keep_empty=0.0), FRAMES, empty, seed) == ()
    assert 30 < len(chosen_frames(half, FRAMES, empty, seed)) < 90
    assert chosen_frames(half, FRAMES, EVERYWHERE, seed) == tuple(FRAMES)


def test_a_world_without_people_gives_empty_frames_in_that_share_too() -> None:
    choice = FrameChoice(frames_per_world=3, keep_empty=0.2)
    found = sum(len(chosen_frames(choice, FRAMES, {}, seed)) for seed in range(300))
    assert found / 900 == pytest.approx(0.2, abs=0.04)


def test_people_who_are_too_small_or_too_hidden_do_not_count() -> None:
    choice = FrameChoice(keep_empty=0.0, least_height_px=20.0, least_visible=0.3)
    assert not choice.suits([SLIVER], may_be_empty=True)
    assert not choice.suits([VisiblePerson(60.0, 0.1)], may_be_empty=True)
    assert choice.suits([SLIVER, ANNA], may_be_empty=False)
    pair = FrameChoice(least_people=2, most_people=3)
    assert [pair.suits([ANNA] * count, may_be_empty=False) for count in range(5)] == [
        False, False, True, True, False,
    ]  # fmt: skip
    assert pair.suits([], may_be_empty=True)


@given(st.integers(1, 9), st.integers(0, 20))
def test_offering_wanted_frames_only_chooses_the_same(count: int, seed: int) -> None:
    choice = FrameChoice(frames_per_world=count)
    people = {frame: [ANNA] for frame in FRAMES if frame % 7 < 2}
    picker = FramePicker(choice, FRAMES, seed)
    found = [frame for frame in FRAMES if picker.wants(frame) and picker.takes(frame, people.get(frame, []))]
    assert tuple(found) == chosen_frames(choice, FRAMES, people, seed)
    assert picker.is_done


def test_a_minimum_above_the_maximum_is_refused() -> None:
    with pytest.raises(BadInput, match="--most-people 1: is below --least-people 2"):
        FrameChoice(least_people=2, most_people=1)
