from __future__ import annotations

import cv2
import pytest

from peopleboy.studies.reproductions.experiments.sliding_windows import (
    BY_SIZE,
    FAR_SLIDES,
    NEAR_SLIDES,
    compare_windows,
)


@pytest.mark.thorough
def test_windows_on_what_has_a_humans_size_are_quicker_and_err_less() -> None:
    threads = cv2.getNumThreads()
    found = compare_windows(["crossing_2_moving"], 1.0, every=7)
    assert cv2.getNumThreads() == threads
    assert set(found) == {
        *(how.key for how in (*FAR_SLIDES, *NEAR_SLIDES)),
        *(f"{kinds} {BY_SIZE}" for kinds in ("near+far", "far", "near")),
        "parts",
    }
    by_size, slid = found[f"far {BY_SIZE}"], found["far 4 px, scale 1.05"]
    assert by_size["images"] == slid["images"] == 2
    assert by_size["people"] == slid["people"] == 4
    assert by_size["found"] >= 3
    assert by_size["false"] < slid["false"]
    assert by_size["ms"] < slid["ms"]
