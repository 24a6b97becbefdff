from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pyarrow as pa
import pytest
from rerun.chunk import RrdReader

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.scenarios.recording.layout import lay_out
from peopleboy.scenarios.recording.recorder import Recorder
from peopleboy.scenarios.recording.recording_file import pack
from peopleboy.scenarios.recording.rows import PIXEL_STEP
from peopleboy.sim.cameras.kinds import colour_from_thermal
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from peopleboy.tracker.reproductions.contour.measurement.section_evidence import section_lines
from peopleboy.tracker.reproductions.contour.variants import VARIANTS
from peopleboy.tracker.trackers import make_tracker
from tests.helpers.runs import synthetic_ticks as made

THERMAL, COLOUR = "/world/robot/thermal", "/world/robot/colour"
FRAMES = 75


class Recording:
    """What is in a recording file, by entity."""

    def __init__(self, path: Path) -> None:
        reader = RrdReader(path)
        (self.entry,) = reader.recordings()
        self.blueprints = reader.blueprints()
        self.batches: dict[str, list[pa.RecordBatch]] = {}
        self.static: dict[str, list[pa.RecordBatch]] = {}
        for chunk in reader.stream():
            kept = self.static if chunk.is_static else self.batches
            kept.setdefault(chunk.entity_path, []).append(chunk.to_record_batch())

    def column(self, path: str, name: str) -> list[object]:
        return [value for batch in self.batches[path] for value in batch.column(name).to_pylist()]


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    path = tmp_path_factory.mktemp("run") / "recording.rrd"
    with Recorder(path, made.config(), title="made, seed 7, tracker contour") as recorder:
        for tick, events in made.make_run(FRAMES):
            recorder.log(tick, events)
    return Recording(path)


@pytest.mark.parametrize(
    "path",
    [
        f"{THERMAL}/image", f"{THERMAL}/tracks/boxes", f"{THERMAL}/tracks/contours", f"{THERMAL}/truth/boxes",
        f"{THERMAL}/tracks/occlusions", f"{THERMAL}/truth/occlusions",
        f"{THERMAL}/particles/people", f"{THERMAL}/particles/detector", f"{COLOUR}/image",
        f"{COLOUR}/tracks/boxes", f"{COLOUR}/truth/boxes", "/world/robot", "/world/trails",
        "/world/occlusions", "/world/people/anna/body", "/world/people/ben/body", "/curves/visible",
        "/curves/motion/speed", "/curves/motion/turn_rate",
    ],
)  # fmt: skip
def test_every_layer_has_a_row_for_every_frame_on_both_timelines(recording: Recording, path: str) -> None:
    assert recording.column(path, "frame") == list(range(1, FRAMES + 1))
    times_ns = [
        time
        for batch in recording.batches[path]
        for time in batch.column("time").cast(pa.int64()).to_pylist()
    ]
    assert times_ns == pytest.approx([k / 15.0 * 1e9 for k in range(FRAMES)], abs=1.0)
    assert set(recording.batches[path][0].schema.names) & {"log_time", "log_tick"} == set()


def test_curves_of_a_track_last_as_long_as_the_track(recording: Recording) -> None:
    assert recording.column("/curves/confidence/track_1", "frame") == list(range(5, 70))
    assert recording.column("/curves/offset/track_1", "Scalars:scalars")[0] == pytest.approx([0.5 / 160.0])


def test_the_curve_of_a_track_has_a_gap_where_it_is_not_in_the_thermal_image(tmp_path: Path) -> None:
    with Recorder(tmp_path / "recording.rrd", made.config(), title="made") as recorder:
        for frame, boxes in enumerate((made.TRACK.boxes, {}, made.TRACK.boxes), start=1):
            recorder.log(made.make_tick(frame, replace(made.TRACK, boxes=boxes)), [])
    (first,), (gap,), (last,) = Recording(tmp_path / "recording.rrd").column(
        "/curves/offset/track_1", "Scalars:scalars"
    )  # type: ignore[misc]
    assert first == last == pytest.approx(0.5 / 160.0)
    assert math.isnan(gap)


def test_a_person_who_left_has_no_body_and_is_not_visible(recording: Recording) -> None:
    bodies = recording.column("/world/people/ben/body", "Capsules3D:translations")
    assert [len(body) > 0 for body in bodies] == [frame < 60 for frame in range(1, FRAMES + 1)]  # type: ignore[arg-type]
    visible = recording.column("/curves/visible", "Scalars:scalars")
    assert visible[-1] == [1.0, 0.0]
    assert visible[29] == pytest.approx([1.0, 0.05])


def test_the_logged_images_are_those_of_the_cameras(recording: Recording) -> None:
    tick, _ = made.make_run(30)[29]
    for path, expected in (
        (THERMAL, tick.observation.images["thermal"]),
        (COLOUR, tick.observation.images["colour"]),
    ):
        (blob,) = recording.column(f"{path}/image", "EncodedImage:blob")[29]  # type: ignore[misc]
        image = cv2.imdecode(np.array(blob, np.uint8), cv2.IMREAD_UNCHANGED)
        shown = image if image.ndim == 2 else image[..., ::-1]
        assert shown.shape == expected.shape
        assert np.abs(shown.astype(float) - expected).mean() < 6.0


def test_a_lossless_recording_has_every_grey_and_colour_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "recording.rrd"
    with Recorder(path, made.config(), title="made", is_lossless=True) as recorder:
        for tick, events in made.make_run(3):
            recorder.log(tick, events)
    found = Recording(path)
    for place, name in ((THERMAL, "thermal_scene"), (COLOUR, "colour")):
        (packing,) = (
            batch.column("EncodedImage:media_type").to_pylist()[0] for batch in found.static[f"{place}/image"]
        )
        assert packing == ["image/png"]
        (blob,) = found.column(f"{place}/image", "EncodedImage:blob")[2]  # type: ignore[misc]
        image = cv2.imdecode(np.array(blob, np.uint8), cv2.IMREAD_UNCHANGED)
        shown = image if image.ndim == 2 else image[..., ::-1]
        assert np.array_equal(shown, tick.observation.images[name])


def test_a_recording_stands_at_its_first_frame_and_a_live_one_follows() -> None:
    for follows, state in ((False, "paused"), (True, "following")):
        panel = lay_out(made.config(), follows=follows).time_panel
        assert (panel.play_state, panel.timeline) == (state, "time")


def test_a_closed_recording_holds_each_layer_in_one_piece(recording: Recording) -> None:
    assert {path: len(batches) for path, batches in recording.batches.items()} == dict.fromkeys(
        recording.batches, 1
    )


def test_every_section_of_a_contour_has_its_points_and_its_colour(recording: Recording) -> None:
    strips = recording.column(f"{THERMAL}/tracks/contours", "LineStrips2D:strips")
    colours = recording.column(f"{THERMAL}/tracks/contours", "LineStrips2D:colors")
    lines = section_lines(made.ELLIPSE, VARIANTS["contour"].contour)
    for frame, (drawn, colour) in enumerate(zip(strips, colours, strict=True), start=1):
        expected = lines if 5 <= frame < 70 else lines[:0]
        assert len(drawn) == len(colour) == len(expected)  # type: ignore[arg-type]
        if len(expected):
            assert np.array(drawn) == pytest.approx(expected + 0.5, abs=PIXEL_STEP / 2)


def test_the_name_of_a_person_is_on_the_body(recording: Recording) -> None:
    (still,) = recording.static["/world/people/anna/body"]
    assert still.column("Capsules3D:labels").to_pylist() == [["anna"]]


def test_boxes_lie_where_the_track_is_and_in_the_colour_image_where_the_affine_says(
    recording: Recording,
) -> None:
    left, top, width, height = made.TRACK.boxes["thermal"]
    robot = made.config().robot
    affine = colour_from_thermal(robot.cameras)
    for path, mapping in ((THERMAL, np.eye(3)[:2]), (COLOUR, affine)):
        (centre,) = recording.column(f"{path}/tracks/boxes", "Boxes2D:centers")[9]  # type: ignore[misc]
        # Rerun counts from the image's corner.
        expected = mapping @ (left + width / 2.0, top + height / 2.0, 1.0) + 0.5
        assert centre == pytest.approx(expected, abs=PIXEL_STEP)


def test_world_and_cameras_are_there_once(recording: Recording) -> None:
    for path in (
        "/world/place/walls/box",
        "/world/place/floor/box",
        "/world/robot/body/box",
        THERMAL,
        COLOUR,
    ):
        assert len(recording.static[path]) == 1
    names = set(recording.static[THERMAL][0].schema.names)
    assert {"Pinhole:image_from_camera", "Transform3D:translation"} <= names


def test_an_arrow_points_from_who_hides_to_who_is_hidden(recording: Recording) -> None:
    labels = recording.column("/world/occlusions", "Arrows3D:labels")
    assert [len(label or []) for label in labels] == [20 <= frame < 40 for frame in range(1, FRAMES + 1)]  # type: ignore[arg-type]
    assert labels[29] == ["95%"]
    # Anna stands at x = 4, ben at 6.
    assert recording.column("/world/occlusions", "Arrows3D:origins")[29] == [pytest.approx([4.0, 0.0, 1.3])]
    assert recording.column("/world/occlusions", "Arrows3D:vectors")[29] == [pytest.approx([2.0, 0.0, 0.0])]


def test_events_are_in_the_log(recording: Recording) -> None:
    texts = [text for (text,) in recording.column("/events", "TextLog:text")]  # type: ignore[misc]
    assert texts == [
        "robot: search", "track 1: detected", "robot: follow", "ben: occlusion by anna starts",
        "ben: occlusion by anna ends", "track 1: lost",
    ]  # fmt: skip


def test_the_recording_is_named_after_scenario_and_seed_and_brings_its_layout(recording: Recording) -> None:
    assert recording.entry.application_id == "peopleboy"
    assert recording.entry.recording_id == "made-seed-7-tracker-contour"
    assert [blueprint.application_id for blueprint in recording.blueprints] == ["peopleboy"]


def test_recording_prints_nothing(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    with Recorder(tmp_path / "recording.rrd", made.config(), title="quiet") as recorder:
        for tick, events in made.make_run(40):
            recorder.log(tick, events)
    assert capfd.readouterr() == ("", "")


def test_a_world_without_people_and_tracks_is_recorded(tmp_path: Path) -> None:
    empty = WorldConfig(place=made.config().place)
    tick = made.make_tick(70, track=None)
    with Recorder(tmp_path / "recording.rrd", empty, title="empty") as recorder:
        recorder.log(tick, [])
    assert Recording(tmp_path / "recording.rrd").column(f"{THERMAL}/tracks/boxes", "frame") == [70]


def _written(path: Path, config: WorldConfig, ticks: list[Tick]) -> int:
    """Record ticks and return the bytes of the file."""
    with Recorder(path, config, title="size") as recorder:
        for tick in ticks:
            recorder.log(tick, [])
    return path.stat().st_size


@pytest.mark.thorough
def test_a_minute_with_four_people_fits_into_eleven_megabytes(tmp_path: Path) -> None:
    scenario = load_scenario("crossing_4")
    config = scenario.world(0)
    with SimulatedWorld(config) as world:
        tracker = make_tracker("contour")
        loop = closed_loop(world, tracker, scenario.make_behaviour(), 75)
        ticks = [replace(tick, truths=dict(tick.truths)) for tick in loop]
    assert np.mean([len(tick.tracks) for tick in ticks[15:]]) > 3.0
    # What is there once must not be counted for every second.
    start, whole = (_written(tmp_path / f"{n}.rrd", config, ticks[:n]) for n in (15, 75))
    assert start + 59 * (whole - start) / 4 < 11e6


def test_a_recording_that_cannot_be_packed_stays_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "recording.rrd"
    path.write_bytes(b"no recording")
    pack(path)
    assert path.read_bytes() == b"no recording"
    assert list(tmp_path.iterdir()) == [path]


_KILLED = """
import os, signal, sys
from pathlib import Path
from peopleboy.scenarios.recording.recorder import Recorder
from tests.helpers.runs import synthetic_ticks as made

recorder = Recorder(Path(sys.argv[1]), made.config(), title="killed")
for tick, events in made.make_run(55):
    recorder.log(tick, events)
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="processes are killed otherwise here")
@pytest.mark.filterwarnings("ignore:RRD file has no footer")
def test_a_killed_run_leaves_a_recording_that_opens(tmp_path: Path) -> None:
    path = tmp_path / "recording.rrd"
    here = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}
    killed = subprocess.run([sys.executable, "-c", _KILLED, str(path)], env=here, check=False)
    assert killed.returncode == -signal.SIGKILL
    frames = Recording(path).column(f"{THERMAL}/image", "frame")
    assert len(frames) >= 45
    assert frames == list(range(1, len(frames) + 1))
