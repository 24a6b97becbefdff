"""Reports on runs whose people are looked for all round the robot."""

from collections.abc import Iterator

import numpy as np
import pytest

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.report.charts.error_curves import curve, distance_edges, samples
from peopleboy.scenarios.report.findings.identity_changes import find_cause
from peopleboy.scenarios.report.findings.run_findings import RunFindings, analyse_run, headline
from peopleboy.scenarios.report.pictures import Origin, show_frames
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions

SCENE = """
name: round
description: Anna stands to the robot's left, Ben far away before it.
duration_s: 1.8
physics: kinematic
place: {kind: room, length_m: 12.0, width_m: 6.0}
people:
  - {name: anna, path: [{at_m: [1.5, 2.4]}]}
  - {name: ben, path: [{at_m: [9.5, 0.0]}]}
robot: {at_m: [1.5, 0.0], cameras: {panorama: {kind: panorama, rate_hz: 5}}}
"""
TRACKER = """
from peopleboy import Status, Track

class Somewhere:
    cameras = ("panorama",)

    def __init__(self, rng):
        pass

    def update(self, frame):
        box = {"panorama": (114.0, 12.0, 12.0, 60.0)}
        return (Track(id=1, boxes=box, confidence=1.0, status=Status.UNKNOWN, age_s=frame.time_s),)

class AtImages(Somewhere):
    def update(self, frame):
        return super().update(frame) if "panorama" in frame.images else ()
"""


@pytest.fixture(scope="module", params=["Somewhere", "AtImages"])
def found(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunFindings]:
    folder = tmp_path_factory.mktemp("round")
    (folder / "round.yaml").write_text(SCENE)
    (folder / "all_round.py").write_text(TRACKER)
    options = RunOptions(
        seed=0, out=folder / "run", frames=True, record=False, tracker=f"all_round:{request.param}"
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        run(load_scenario(folder / "round.yaml"), options, lambda *_: None)
        yield analyse_run(open_run(folder / "run"))


@pytest.mark.slow
def test_people_count_within_the_limits_of_panoramas(found: RunFindings) -> None:
    assert found.camera == "panorama"
    assert "1 more never visible at 1.1 to 7 m" in headline([found])
    assert str(find_cause(found, found.called("ben"), 0, 0)) == "was beyond 7 m"
    edges = distance_edges([found])
    assert edges == (1.1, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0)
    assert [(point.x, point.boxes) for point in curve([samples(found)], "distance", "found", edges)] == [
        (2.5, 9)
    ]


def test_between_two_images_people_are_as_the_former_showed_them(found: RunFindings) -> None:
    anna = found.called("anna")
    assert anna.is_due.all()  # and not in one frame of three, so that each image were a moment of its own
    assert len(set(anna.state.tolist())) == 1
    assert found.shown[1].all()


def test_pictures_are_the_newest_panoramas(found: RunFindings) -> None:
    shown = show_frames(found, [4, 6, 7])
    assert [(still.camera, still.time_s, still.origin) for still in shown.values()] == [
        ("panorama", 0.2, Origin.FRAMES),
        ("panorama", 0.2, Origin.FRAMES),
        ("panorama", 0.4, Origin.FRAMES),
    ]
    assert shown[4].picture.shape == (240, 960, 3)
    left, right = shown[4].picture[:, 200:300], shown[4].picture[:, 600:700]
    assert len(np.unique(left.reshape(-1, 3), axis=0)) > len(np.unique(right.reshape(-1, 3), axis=0))
