import math

import pytest
from click.testing import CliRunner

from benchmarks import all_round
from benchmarks.all_round import Play, Played, _distance_error, _Rows, _Watch
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.tracker.trackers import TRACKERS

ROUND_M = 0.01**2, 0.0, 0.01**2


def rows(frames=20, off=(0.0, 0.0), numbers=(7, 7), where=(3.0, 1.0), counts=True):
    """One person who stands, and its track so far off."""
    made = _Rows()
    for frame in range(1, frames + 1):
        made.truth.append((frame, 1, *where, counts, 1.0))
        made.tracks.append(
            (frame, numbers[2 * frame > frames + 1], where[0] + off[0], where[1] + off[1], *ROUND_M)
        )
    return made


def test_who_is_right_has_all_the_scores():
    scores = rows().scores(20)
    assert scores.mot.identity.idf1 == pytest.approx(100.0)
    assert scores.counts.matches == scores.counts.targets == 20
    assert scores.floor.mean_m == pytest.approx(0.0)


def test_errors_are_those_of_the_places():
    made = rows(off=(0.03, -0.04))
    assert made.scores(20).floor.mean_m == pytest.approx(0.05)
    error, count = _distance_error(made)
    assert count == 20
    assert error == pytest.approx(abs(math.hypot(3.03, 0.96) - math.hypot(3.0, 1.0)))


def test_another_number_halfway_costs_half_of_who_is_who():
    scores = rows(numbers=(7, 8)).scores(20)
    assert scores.mot.identity.idf1 == pytest.approx(50.0)
    assert scores.counts.matches == 20


def test_whoever_does_not_count_is_not_missed_nor_measured():
    made = rows(counts=False)
    assert made.scores(20).counts.targets == 0
    assert _distance_error(made)[1] == 0
    assert math.isnan(_distance_error(made)[0])


def test_without_tracks_nobody_is_found():
    made = rows()
    made.tracks.clear()
    assert made.scores(20).counts.matches == 0
    assert math.isnan(_distance_error(made)[0])


def times_of(text):
    """Times of handover; each letter is a tenth of a second: out of the image, in it, in it with a box."""
    watch = _Watch(seen=[(k / 10, one != "-") for k, one in enumerate(text)])
    return list(watch.times_s([one == "X" for one in text]))


@pytest.mark.parametrize(
    ("text", "times"),
    [
        ("---XXX", [0.0]),
        ("---iiXX", [0.2]),
        ("---ii---", [math.nan]),
        ("--iXX--XX", [0.1, 0.0]),
        ("iiXX", []),
        ("----", []),
        ("--iii", []),
    ],
)
def test_a_handover_takes_from_coming_into_the_image_to_the_first_box(text, times):
    assert times_of(text) == pytest.approx(times, nan_ok=True)


def test_all_that_it_plays_can_be_made_and_its_table_is_printed(monkeypatch):
    played = []

    def pretend(tasks, *_):
        played.extend(task for several in tasks.values() for task in several)
        one = Played(rows().scores(20), (0.1, 5), 3.0, (0.2, math.nan), numbers=frozenset({1}))
        return {key: [one] * len(several) for key, several in tasks.items()}

    monkeypatch.setattr(all_round, "compare", pretend)
    monkeypatch.setattr(all_round, "time_beside_hog", lambda *_: (3.0, 60.0))
    told = CliRunner().invoke(all_round.main, ["--seeds", "2", "--laps", "3", "--workers", "1"])
    assert told.exit_code == 0, told.output
    assert "one identity in 3 of 3 runs" in told.output
    assert "3.00 ms per image, HOG 60.0 ms; scaled to HOG at 80 ms: 4.0 ms" in told.output
    assert "0.20 s on average" in told.output
    assert "never in 3 of 6" in told.output
    assert len({task.name for task in played}) == len(played)
    for task in played:
        cameras = all_round._make(task.tracker, 0).cameras
        assert "panorama" in load_scenario(task.scenario).mounting(cameras).robot.cameras
        assert task.tracker in (*TRACKERS, all_round.ONE_IMAGE)
    assert {task.scenario for task in played} >= {all_round.ROUND}


def test_the_name_of_a_run_tells_which():
    assert Play("room_long", "panoramic", 3).name == "room_long panoramic 3"
