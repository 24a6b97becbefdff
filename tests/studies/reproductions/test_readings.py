from __future__ import annotations

import pytest

from peopleboy.studies.reproductions.measuring.readings import AS_READ, READINGS
from peopleboy.studies.reproductions.measuring.tracker_settings import BASES, Setting


@pytest.mark.parametrize("name", READINGS)
def test_every_reading_but_the_first_makes_another_tracker(name: str) -> None:
    config = Setting("thesis-single", READINGS[name]).config()
    assert (config == BASES["thesis-single"]) == (name == AS_READ)
