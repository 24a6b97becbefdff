"""What is said of a run in a sentence."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.scores.corridor_metrics import CorridorScore
from peopleboy.scenarios.scores.episode_result import DriveScores
from peopleboy.scenarios.scores.following_metrics import score_following
from peopleboy.scenarios.scores.run_scores import RunScores, headline
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.mot_files import read_tracks, read_truth
from tests.helpers.drives import made_drive

CORRIDOR = CorridorScore(
    lateral_rms_m=0.05,
    lateral_max_m=0.1,
    heading_error_rad=0.0,
    contacts=0,
    mean_speed_m_s=0.5,
    way_m=12.0,
    legs=1,
)


def scores_of(folder: Path, found: int, false: int = 0) -> Scores:
    truth, tracks = folder / "gt.txt", folder / "tracks.txt"
    truth.write_text("".join(f"{frame},1,10,10,20,60,1,1,1.0\n" for frame in range(1, 201)))
    right = [f"{frame},4,10,10,20,60,1,-1,-1,-1\n" for frame in range(1, found + 1)]
    wrong = [f"1,{9 + number},200,10,20,60,1,-1,-1,-1\n" for number in range(false)]
    tracks.write_text("".join(right + wrong))
    return evaluate(read_truth(truth), read_tracks(tracks), frames=200)


def test_who_counts_is_said_where_nobody_does(tmp_path: Path) -> None:
    scores = scores_of(tmp_path, 200)
    (tmp_path / "gt.txt").write_text("1,1,10,10,20,60,0,1,1.0\n")
    nobody = evaluate(read_truth(tmp_path / "gt.txt"), read_tracks(tmp_path / "tracks.txt"), frames=200)
    assert "3 to 10 m" in headline(RunScores(nobody))
    assert "3 to 10 m" not in headline(RunScores(scores))


@pytest.mark.parametrize(
    ("found", "false", "clues"),
    [
        (200, 0, ["100 % of 200 cases", "100 % of boxes are correct", "no identity switch, no false track."]),
        (199, 1, ["99 % of 200 cases", "99 % of boxes", "1 false track."]),
        (1, 2, ["1 % of 200 cases", "2 false tracks."]),
        (0, 0, ["0 % of 200 cases, there are no boxes"]),
    ],
)
def test_all_means_all_and_none_means_none(found: int, false: int, clues: list[str], tmp_path: Path) -> None:
    text = headline(RunScores(scores_of(tmp_path, found, false)))
    assert [clue for clue in clues if clue not in text] == []


def test_who_follows_somebody_else_is_told_so(tmp_path: Path) -> None:
    people = scores_of(tmp_path, 200)
    still = np.zeros(30, dtype=np.bool_)
    run = made_drive(
        np.arange(30) / 15.0,
        np.zeros((30, 3)),
        target=np.full((30, 2), 3.0),
        track=np.ones(30, np.int64),
        is_wrong=np.arange(30) < 12,
    )
    assert "followed another person for 0.8 s; no contact" in headline(
        RunScores(people, DriveScores(following=score_following(run)))
    )
    right = dataclasses.replace(run, is_wrong=still)
    assert "to the end; no contact" in headline(
        RunScores(people, DriveScores(following=score_following(right)))
    )


def test_a_corridor_without_a_straight_leg_says_nothing_of_its_middle(tmp_path: Path) -> None:
    people = scores_of(tmp_path, 200)
    assert "lateral error of 0.05 m RMS; no contact" in headline(
        RunScores(people, DriveScores(corridor=CORRIDOR))
    )
    bent = dataclasses.replace(CORRIDOR, lateral_rms_m=math.nan, contacts=2)
    assert "0.50 m/s; 2 contacts" in headline(RunScores(people, DriveScores(corridor=bent)))
