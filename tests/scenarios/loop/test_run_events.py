from __future__ import annotations

from dataclasses import replace

from peopleboy.scenarios.loop.run_events import TrackEvent, TrackEvents
from peopleboy.tracker.track import Status, Track
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs import synthetic_ticks as made

WIDTH = 320


def play(*frames: tuple[Track, ...]) -> list[list[TrackEvent]]:
    """What happens when these frames, a second apart, follow each other."""
    events = TrackEvents()
    return [events.update(tracks, float(second), WIDTH) for second, tracks in enumerate(frames)]


def hidden(by: int | None) -> Track:
    return replace(made.with_status(Status.TOTALLY_OCCLUDED), occluder=by)


def partly(by: int) -> Track:
    return replace(made.with_status(Status.PARTLY_OCCLUDED), occluder=by)


def test_a_track_is_detected_once_and_not_while_it_is_tentative() -> None:
    found = play((made.with_status(Status.TENTATIVE),), (made.TRACK,), (made.TRACK,))
    assert found == [[], [TrackEvent(kind="detected", track=1)], []]


def test_who_was_hidden_and_forgotten_is_re_identified_under_the_old_id() -> None:
    found = play((made.TRACK,), (hidden(2),), (), (), (made.TRACK,))
    assert [[event.kind for event in events] for events in found] == [
        ["detected"], ["hidden"], ["lost"], [], ["re-identified"],
    ]  # fmt: skip
    assert found[1][0].by == 2
    assert_names(found[2][0].why, "occluded", "track 2")
    assert found[4][0].why == "after 3.0 s"


def test_a_lost_track_left_the_image_or_is_found_no_more() -> None:
    outside = made.with_box((300.0, 50.0, 40.0, 170.0))
    weak = replace(made.with_status(Status.TENTATIVE), confidence=0.12)
    assert play((outside,), ())[1][0].why.endswith("right")
    assert play((made.with_box((-20.0, 50.0, 40.0, 170.0)),), ())[1][0].why.endswith("left")
    assert_names(play((made.TRACK,), (weak,))[1][0].why, "not detected", "0.12")


def test_who_is_known_again_after_some_images_goes_on_under_the_old_number_and_is_not_lost() -> None:
    late = replace(made.TRACK, id=3)
    found = play((made.TRACK,), (), (), (late,), (made.TRACK,), (made.TRACK,))
    known = TrackEvent(kind="re-identified", track=3, by=1, why="after 3.0 s")
    assert found[3:] == [[TrackEvent(kind="detected", track=3)], [known], []]


def test_who_comes_back_elsewhere_is_no_other_track_that_ends() -> None:
    aside = replace(made.with_box((20.0, 47.3, 40.0, 175.0)), id=3)
    found = play((made.TRACK,), (), (aside,), (made.TRACK,))
    assert [(event.kind, event.track, event.by) for event in found[3]] == [
        ("re-identified", 1, None),
        ("lost", 3, None),
    ]


def test_a_track_that_goes_on_under_a_new_number_did_not_lose_its_contour() -> None:
    found = play((made.TRACK,), (replace(made.TRACK, id=7),))[1]
    assert [(event.kind, event.track) for event in found] == [("lost", 1), ("detected", 7)]
    assert found[0].why == "replaced by track 7"


def test_an_occlusion_is_told_once_per_pair_however_often_it_flickers() -> None:
    events = TrackEvents()
    found = [
        [event.kind for event in events.update((track,), 0.1 * k, WIDTH)]
        for k, track in enumerate([made.TRACK, partly(2), made.TRACK, partly(2), partly(3)])
    ]
    assert found == [["detected"], ["occluded"], [], [], ["occluded"]]
