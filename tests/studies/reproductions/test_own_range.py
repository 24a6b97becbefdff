from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.running.frame_cache import Film
from peopleboy.studies.reproductions.measuring import units
from peopleboy.studies.reproductions.measuring.units import track_film
from peopleboy.tracker.frame import THERMAL, Frame, PinholeCalibration
from peopleboy.tracker.track import FloorPlace, Status, Track

CAMERA_X_M = 0.5
CAMERA = np.eye(4)
CAMERA[0, 3] = CAMERA_X_M
FRAME = Frame(
    images={THERMAL: np.zeros((24, 32), np.uint8)},
    calibrations={THERMAL: PinholeCalibration(np.diag([30.0, 30.0, 1.0]), CAMERA)},
    time_s=0.0,
)


class Told:
    """Sees people straight ahead, as far from the camera as it was told, or at no known place."""

    cameras = (THERMAL,)

    def __init__(self, *distances_m: float | None) -> None:
        self.distances_m = distances_m

    def update(self, frame: Frame) -> tuple[Track, ...]:  # noqa: ARG002
        return tuple(
            Track(
                id=number,
                boxes={THERMAL: (0.0, 0.0, 5.0, 15.0)},
                place=None
                if away is None
                else FloorPlace(position_m=(away + CAMERA_X_M, 0.0), covariance_m2=(1, 0, 1)),
                confidence=1.0,
                status=Status.TRACKED,
                age_s=1.0,
            )
            for number, away in enumerate(self.distances_m, 1)
        )


def test_people_are_in_range_from_3_to_10_m_from_the_camera_or_at_no_known_place(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(units, "frames_of", lambda _film, _cameras: iter([FRAME]))
    film = Film(Path("nowhere"), "made_up", 0, 1, {}, {})
    found, is_in_range = track_film(film, Told(2.9, 3.1, 9.9, 10.1, None))
    assert found.id.tolist() == [1, 2, 3, 4, 5]
    assert is_in_range.tolist() == [False, True, True, False, True]
