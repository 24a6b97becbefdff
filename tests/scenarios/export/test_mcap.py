from __future__ import annotations

import math
import subprocess
import sys
from collections import defaultdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from scipy.spatial.transform import Rotation

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.export.ros.robot_messages import OdometryCovariance, drift
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.sim.robot.robot_body import WHEEL_DISTANCE_M
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.runs.exported import export

ULTRASOUND, DELETE_ALL, CYLINDER, TEXT = 0, 3, 3, 9  # of sensor_msgs/Range and visualization_msgs/Marker
RANGES = {f"/sonar_{k:02d}/range" for k in range(16)}
MARKERS = {"/tracks/markers", "/truth/markers"}
ONCE = {"/tf_static", "/robot_description"}
TOPICS = RANGES | MARKERS | {
    "/thermal/image_raw/compressed", "/colour/image_raw/compressed", "/thermal/camera_info",
    "/colour/camera_info",
    "/thermal/image16", "/truth/people", "/truth/colour/people", "/tracks", "/tracks/places", "/sonar",
    "/odom", "/tf", "/clock", "/people", "/truth/positions",
}  # fmt: skip

# SHA-256 of a type and all that it is made of, as ROS 2's own builds have them (REP 2011); those of
# Detection3DArray, MarkerArray, People and Range follow from the published definitions.
HASHES = {
    "nav_msgs/msg/Odometry": "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
    "people_msgs/msg/People": "9ea98a5e58f833a9532957bca23a6b8006a12885d5a16c8ca41dd901d10c33b6",
    "rosgraph_msgs/msg/Clock": "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564",
    "sensor_msgs/msg/CameraInfo": "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275",
    "sensor_msgs/msg/CompressedImage": "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a",
    "sensor_msgs/msg/Image": "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
    "sensor_msgs/msg/PointCloud2": "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5",
    "sensor_msgs/msg/Range": "b42b62562e93cbfe9d42b82fe5994dfa3d63d7d5c90a317981703f7388adff3a",
    "std_msgs/msg/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "tf2_msgs/msg/TFMessage": "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "vision_msgs/msg/Detection2DArray": "214274120007f4a683866481336b70310268cfa107aebe9d594a6acf75bda968",
    "vision_msgs/msg/Detection3DArray": "793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018",
    "visualization_msgs/msg/MarkerArray": "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf",
}

lengths, turns = st.floats(-20.0, 20.0), st.floats(-math.pi, math.pi)
poses = st.builds(Pose2, lengths, lengths, turns)


@pytest.fixture(scope="module")
def bag(crossing: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(crossing, "mcap", tmp_path_factory.mktemp("mcap") / "set") / "tiny-3"


@pytest.fixture(scope="module")
def messages(bag: Path) -> dict[str, list[Any]]:
    """All messages by topic, read by another library than the one that wrote them."""
    found = defaultdict(list)
    with (bag / "tiny-3.mcap").open("rb") as file:
        for _, channel, _, message in make_reader(
            file, decoder_factories=[DecoderFactory()]
        ).iter_decoded_messages():
            found[channel.topic].append(message)
    return found


def stamp_of(message: Any) -> Any:
    """The stamp of a message, or of the first that it holds."""
    if hasattr(message, "clock"):
        return message.clock
    (inner, *_) = getattr(message, "transforms", None) or getattr(message, "markers", None) or (message,)
    return inner.header.stamp


def seconds(message: Any) -> float:
    return stamp_of(message).sec + 1e-9 * stamp_of(message).nanosec


def pose(transform: Any) -> np.ndarray:
    matrix = np.eye(4)
    turn, place = transform.rotation, transform.translation
    matrix[:3, :3] = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w]).as_matrix()
    matrix[:3, 3] = (place.x, place.y, place.z)
    return matrix


@pytest.mark.slow
def test_every_topic_has_a_message_a_frame(messages: dict[str, list[Any]]) -> None:
    assert {topic: len(found) for topic, found in messages.items()} == dict.fromkeys(
        TOPICS, 60
    ) | dict.fromkeys(ONCE, 1)
    for topic in TOPICS:
        assert [seconds(message) for message in messages[topic]] == pytest.approx(np.arange(60) / 15.0)


def test_the_images_are_those_of_the_run(messages: dict[str, list[Any]], crossing: Path) -> None:
    for frame in (1, 40):
        name = f"{frame:06d}.png"
        thermal = np.frombuffer(messages["/thermal/image_raw/compressed"][frame - 1].data, np.uint8)
        stored = cv2.imread(str(crossing / "thermal" / name), cv2.IMREAD_UNCHANGED)
        assert np.array_equal(cv2.imdecode(thermal, cv2.IMREAD_UNCHANGED), stored)
        colour = np.frombuffer(messages["/colour/image_raw/compressed"][frame - 1].data, np.uint8)
        lost = cv2.absdiff(
            cv2.imdecode(colour, cv2.IMREAD_COLOR), cv2.imread(str(crossing / "colour" / name))
        )
        assert lost.mean() < 5.0


def test_raw_thermal_images_are_those_of_the_run_without_loss(
    messages: dict[str, list[Any]], crossing: Path
) -> None:
    for frame in (1, 40):
        message = messages["/thermal/image16"][frame - 1]
        stored = cv2.imread(str(crossing / "thermal16" / f"{frame:06d}.png"), cv2.IMREAD_UNCHANGED)
        found = np.frombuffer(message.data, "<u2").reshape(message.height, message.width)
        assert (message.encoding, message.step) == ("16UC1", 2 * message.width)
        assert np.array_equal(found, stored)


def test_points_of_sonars_lie_where_the_ring_heard_something(
    messages: dict[str, list[Any]], crossing: Path
) -> None:
    run = open_run(crossing)
    for message, row in zip(messages["/sonar"], run.files().robot.to_pylist(), strict=True):
        assert [field.name for field in message.fields] == ["x", "y", "z", "range"]
        assert (message.header.frame_id, message.width) == ("base_link", 16)
        points = np.frombuffer(message.data, "<f4").reshape(16, 4)
        assert points[:, 3] == pytest.approx(row["sonar_m"], abs=1e-6)
        assert points[:, 2] == pytest.approx(run.robot.sonar.height_m)
        # By ARIA's file, 3 looks ahead by the left, and 7 and 8 square to the right.
        third, seventh = points[3], points[7]
        turn = math.radians(10.0)
        assert third[:2] == pytest.approx(
            [0.166 + third[3] * math.cos(turn), 0.027 + third[3] * math.sin(turn)], abs=1e-5
        )
        assert seventh[:2] == pytest.approx([0.069, -0.136 - seventh[3]], abs=1e-5)


def test_each_sonar_has_a_range_and_a_frame_of_its_own(
    messages: dict[str, list[Any]], crossing: Path
) -> None:
    run = open_run(crossing)
    frames = {one.child_frame_id: pose(one.transform) for one in messages["/tf_static"][0].transforms}
    points = np.frombuffer(messages["/sonar"][5].data, "<f4").reshape(16, 4)
    for k in range(16):
        for message, row in zip(
            messages[f"/sonar_{k:02d}/range"], run.files().robot.to_pylist(), strict=True
        ):
            assert message.header.frame_id == f"sonar_{k:02d}"
            assert message.range == pytest.approx(row["sonar_m"][k], abs=1e-6)
            assert (message.radiation_type, message.max_range) == (ULTRASOUND, 5.0)
        reading = messages[f"/sonar_{k:02d}/range"][5].range
        end = frames[f"sonar_{k:02d}"] @ [reading, 0.0, 0.0, 1.0]
        assert end[:3] == pytest.approx(points[k, :3], abs=1e-5)


def test_markers_and_people_stand_where_the_truth_has_them(
    messages: dict[str, list[Any]], crossing: Path
) -> None:
    table = pq.read_table(crossing / "truth.parquet").to_pylist()
    for frame in (1, 40):
        rows = {row["name"]: row for row in table if row["frame"] == frame}
        people = {person.name: person for person in messages["/truth/positions"][frame - 1].people}
        first, *markers = messages["/truth/markers"][frame - 1].markers
        assert (first.action, {marker.header.frame_id for marker in markers}) == (DELETE_ALL, {"map"})
        labels = {m.id: m.text for m in markers if m.type == TEXT}
        bodies = {labels[m.id]: m for m in markers if m.type == CYLINDER}
        assert people.keys() == bodies.keys() == rows.keys()
        for name, row in rows.items():
            here = pytest.approx([row["x_m"], row["y_m"]])
            assert [people[name].position.x, people[name].position.y] == here
            assert [bodies[name].pose.position.x, bodies[name].pose.position.y] == here
            assert 1.4 < bodies[name].scale.z < 2.1
            assert math.hypot(people[name].velocity.x, people[name].velocity.y) < 1.3


def test_tracks_as_people_move_as_the_truth_does(messages: dict[str, list[Any]]) -> None:
    (anna,) = (person for person in messages["/truth/positions"][44].people if person.name == "anna")
    message = messages["/people"][44]
    assert message.header.frame_id == "odom"
    near = min(message.people, key=lambda one: abs(one.velocity.y - anna.velocity.y))
    assert near.velocity.y == pytest.approx(anna.velocity.y, abs=0.4)
    assert (near.tagnames, 0.0 < near.reliability <= 1.0) == (["status"], True)
    assert len(messages["/tracks/markers"][44].markers) == 1 + 2 * len(message.people)


def test_the_description_is_a_urdf_whose_links_all_have_frames(messages: dict[str, list[Any]]) -> None:
    root = ElementTree.fromstring(messages["/robot_description"][0].data)
    frames = {one.child_frame_id for one in messages["/tf_static"][0].transforms}
    links = {link.get("name") for link in root.iterfind("./link")}
    assert "base_link" in links
    assert links - {"base_link"} <= frames
    assert {joint.get("link") for joint in root.iterfind("./joint/parent")} == {"base_link"}


def test_stamps_begin_at_an_epoch_and_humble_has_its_own_range(crossing: Path, tmp_path: Path) -> None:
    out = tmp_path / "set"
    options = ("--epoch", "2026-05-01T12:00:00Z", "--ros-distro", "humble")
    assert run_cli("export", crossing, "--format", "mcap", "--out", out, *options) == 0
    start_ns = round(datetime(2026, 5, 1, 12, tzinfo=UTC).timestamp()) * 10**9
    with AnyReader([out / "tiny-3"]) as reader:
        assert reader.start_time == start_ns
        (connection,) = (one for one in reader.connections if one.topic == "/sonar_00/range")
        _, time_ns, raw = next(reader.messages([connection]))
        message = reader.deserialize(raw, connection.msgtype)
    assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == time_ns == start_ns
    assert not hasattr(message, "variance")


@pytest.mark.parametrize("epoch", ["soon", "1969-01-01", "2040-01-01T00:00:00Z"])
def test_what_is_no_time_for_ros_is_refused(
    crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], epoch: str
) -> None:
    given = ("export", crossing, "--format", "mcap", "--out", tmp_path / "out", "--epoch", epoch)
    assert f"--epoch {epoch}" in refusal(capsys, *given)


def test_boxes_are_those_of_truth_and_tracks(messages: dict[str, list[Any]], crossing: Path) -> None:
    files = {
        "/truth/people": "truth/gt.txt",
        "/truth/colour/people": "truth/colour.gt.txt",
        "/tracks": "tracks.txt",
    }
    for topic, file in files.items():
        table = np.loadtxt(crossing / file, delimiter=",")
        found = []
        for frame, message in enumerate(messages[topic], start=1):
            for one in message.detections:
                middle, width, height = one.bbox.center.position, one.bbox.size_x, one.bbox.size_y
                score = one.results[0].hypothesis.score
                found.append((frame, middle.x - width / 2, middle.y - height / 2, width, height, score))
        columns = [0, 2, 3, 4, 5, 6 if topic == "/tracks" else 8]
        assert np.array(found) == pytest.approx(table[:, columns], abs=0.0051)


def test_the_frames_lead_from_the_camera_to_where_the_robot_truly_is(
    messages: dict[str, list[Any]], crossing: Path
) -> None:
    (fixed,) = messages["/tf_static"]
    camera = pose(next(t.transform for t in fixed.transforms if t.child_frame_id == "thermal_optical"))
    run = open_run(crossing)
    assert camera == pytest.approx(run.robot.cameras["thermal"].camera.robot_from_camera)
    for message, row in zip(messages["/tf"], run.files().robot.to_pylist(), strict=True):
        frames = {
            one.child_frame_id: (one.header.frame_id, pose(one.transform)) for one in message.transforms
        }
        assert (frames["odom"][0], frames["base_link"][0], frames["people/anna"][0]) == ("map", "odom", "map")
        robot = frames["odom"][1] @ frames["base_link"][1]
        assert robot[:2, 3] == pytest.approx([row["x_m"], row["y_m"]])
        assert math.atan2(robot[1, 0], robot[0, 0]) == pytest.approx(row["heading_rad"])


def test_the_odometry_is_that_of_the_run(messages: dict[str, list[Any]], crossing: Path) -> None:
    rows = pq.read_table(crossing / "robot.parquet").to_pylist()
    for message, row in zip(messages["/odom"], rows, strict=True):
        place = message.pose.pose.position
        assert (place.x, place.y) == (row["odometry_x_m"], row["odometry_y_m"])
        speed = (row["left_wheel_m_s"] + row["right_wheel_m_s"]) / 2.0
        assert message.twist.twist.linear.x == pytest.approx(speed)


def test_whoever_knows_frames_and_camera_alone_finds_every_joint_at_its_pixel(
    messages: dict[str, list[Any]], crossing: Path
) -> None:
    fixed = {one.child_frame_id: one for one in messages["/tf_static"][0].transforms}
    assert {one.header.frame_id for one in fixed.values()} == {"base_link"}
    people = pq.read_table(crossing / "truth.parquet").to_pylist()
    for row in people:
        moving = {
            one.child_frame_id: pose(one.transform) for one in messages["/tf"][row["frame"] - 1].transforms
        }
        info = messages["/thermal/camera_info"][row["frame"] - 1]
        camera = moving["odom"] @ moving["base_link"] @ pose(fixed[info.header.frame_id].transform)
        joints = np.array(row["joints_m"]).reshape(17, 3)
        seen = np.linalg.inv(camera) @ np.hstack([joints, np.ones((17, 1))]).T
        pixels = np.reshape(info.p, (3, 4)) @ seen
        stored = np.array(row["joints_px"]).reshape(17, 2)
        assert np.abs((pixels[:2] / pixels[2]).T - stored).max() < 0.02
        body = moving[f"people/{row['name']}"]
        assert body[:2, 3] == pytest.approx([row["x_m"], row["y_m"]])
        assert math.remainder(
            math.atan2(body[1, 0], body[0, 0]) - row["heading_rad"], math.tau
        ) == pytest.approx(0.0, abs=1e-9)


def test_camera_info_is_that_of_the_cameras(messages: dict[str, list[Any]], crossing: Path) -> None:
    robot = open_run(crossing).robot
    for name, camera in (
        ("thermal", robot.cameras["thermal"].camera),
        ("colour", robot.cameras["colour"].camera),
    ):
        for info in messages[f"/{name}/camera_info"]:
            assert (info.width, info.height, info.distortion_model) == (
                camera.width,
                camera.height,
                "plumb_bob",
            )
            assert (list(info.d), info.header.frame_id) == ([0.0] * 5, f"{name}_optical")
            assert np.array_equal(np.reshape(info.k, (3, 3)), camera.intrinsics)
            assert np.array_equal(np.reshape(info.p, (3, 4))[:, :3], camera.intrinsics)
            assert np.array_equal(np.reshape(info.r, (3, 3)), np.eye(3))


def test_every_distribution_from_humble_on_can_read_what_lies_beside_the_messages(bag: Path) -> None:
    about = yaml.safe_load((bag / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    # Humble reads profiles as a text with numbers, which is what they are up to version 8.
    assert (about["version"], about["storage_identifier"]) == (8, "mcap")
    assert (about["relative_file_paths"], about["compression_mode"]) == (["tiny-3.mcap"], "")
    assert (about["starting_time"], about["duration"]) == (
        {"nanoseconds_since_epoch": 0},
        {"nanoseconds": round(59e9 / 15.0)},
    )
    for topic in about["topics_with_message_count"]:
        told = topic["topic_metadata"]
        (quality,) = yaml.safe_load(told["offered_qos_profiles"])
        is_static = told["name"] in ONCE
        # RELIABLE; TRANSIENT_LOCAL or VOLATILE; KEEP_LAST.
        assert (quality["reliability"], quality["durability"]) == (1, 1 if is_static else 2)
        assert (quality["history"], quality["depth"]) == (1, 1 if is_static else 10)
        assert told["serialization_format"] == "cdr"
        assert told["type_description_hash"] == f"RIHS01_{HASHES[told['type']]}"
        assert topic["message_count"] == (1 if is_static else 60)


def test_schemas_define_every_type_that_they_use(bag: Path) -> None:
    basic = {"string", "bool", "float32", "float64", "int32", "uint32", "uint8"}
    with (bag / "tiny-3.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert {schema.name for schema in summary.schemas.values()} == HASHES.keys()
    for schema in summary.schemas.values():
        assert schema.encoding == "ros2msg"
        own, *others = schema.data.decode().split(f"{'=' * 80}\nMSG: ")
        known = {other.split("\n", 1)[0] for other in others} | basic
        lines = [
            line
            for text in (own, *(other.split("\n", 1)[1] for other in others))
            for line in text.splitlines()
        ]
        assert {line.split()[0].split("[")[0] for line in lines if line} <= known


def test_the_folder_is_a_bag_of_ros_2_with_little_endian_messages_in_order_of_time(bag: Path) -> None:
    assert {path.name for path in bag.iterdir()} == {"tiny-3.mcap", "metadata.yaml"}
    times = []
    with AnyReader([bag]) as reader:
        assert set(reader.topics) == TOPICS | ONCE
        assert reader.message_count == 60 * len(TOPICS) + len(ONCE)
        for connection, time_ns, raw in reader.messages():
            assert bytes(raw[:4]) == b"\0\1\0\0"
            content = reader.deserialize(raw, connection.msgtype)
            if connection.topic != "/robot_description":
                assert stamp_of(content).sec * 10**9 + stamp_of(content).nanosec == time_ns
            times.append(time_ns)
    assert times == sorted(times)


@pytest.mark.thorough
def test_rerun_understands_the_file(bag: Path, tmp_path: Path) -> None:
    def rerun(*arguments: object) -> str:
        call = [sys.executable, "-m", "rerun", *map(str, arguments)]
        done = subprocess.run(call, check=True, capture_output=True, text=True)
        return done.stdout + done.stderr

    checked = [line.split() for line in rerun("mcap", "check", bag / "tiny-3.mcap").splitlines()]
    assert {line[3] for line in checked if line and line[0] == "ok"} == TOPICS | ONCE
    rerun("mcap", "convert", bag / "tiny-3.mcap", "--output", tmp_path / "tiny.rrd")
    told = rerun("rrd", "print", tmp_path / "tiny.rrd")
    for kind in ("EncodedImage:blob", "Pinhole:image_from_camera", "Transform3D:quaternion"):
        assert kind in told


@given(true=poses, odometry=poses)
def test_the_drift_and_the_odometry_make_the_true_pose(true: Pose2, odometry: Pose2) -> None:
    off = drift(true, odometry)
    cos, sin = math.cos(off.heading), math.sin(off.heading)
    x = off.x + cos * odometry.x - sin * odometry.y
    y = off.y + sin * odometry.x + cos * odometry.y
    assert (x, y) == pytest.approx((true.x, true.y), abs=1e-9)
    assert math.remainder(off.heading + odometry.heading - true.heading, math.tau) == pytest.approx(
        0.0, abs=1e-9
    )


NOISE_M = 0.005  # more than the robot's, and not so much that what is left out tells


def drives(advance_m: float, turn_rad: float, count: int) -> np.ndarray:
    """Poses (count, 3) that encoders with noise add up to, 60 steps on."""
    rng = np.random.default_rng(1)
    true = advance_m + np.array([-0.5, 0.5]) * turn_rad * WHEEL_DISTANCE_M
    x, y, heading = np.zeros((3, count))
    for _ in range(60):
        left, right = true[:, None] + NOISE_M * np.sqrt(np.abs(true))[:, None] * rng.normal(size=(2, count))
        turn, advance = (right - left) / WHEEL_DISTANCE_M, (left + right) / 2.0
        x, y = x + advance * np.cos(heading + turn / 2.0), y + advance * np.sin(heading + turn / 2.0)
        heading = heading + turn
    return np.stack([x, y, heading], axis=1)


@pytest.mark.parametrize(("advance_m", "turn_rad"), [(0.03, 0.0), (0.03, 0.02), (0.0, 0.05), (-0.02, -0.01)])
def test_the_covariance_is_that_of_many_drives(advance_m: float, turn_rad: float) -> None:
    noise, pose = OdometryCovariance(NOISE_M), Pose2(0.0, 0.0, 0.0)
    assert not noise.carry(pose).any()
    for _ in range(60):
        middle = pose.heading + turn_rad / 2.0
        heading = math.remainder(pose.heading + turn_rad, math.tau)
        pose = Pose2(pose.x + advance_m * math.cos(middle), pose.y + advance_m * math.sin(middle), heading)
        covariance = noise.carry(pose)
    true = np.cov(drives(advance_m, turn_rad, 20_000).T)
    scale = np.sqrt(np.outer(np.diag(true), np.diag(true))) + 1e-9
    assert np.abs((covariance - true) / scale).max() < 0.06


def test_who_stands_stays_as_sure() -> None:
    noise = OdometryCovariance(0.002)
    noise.carry(Pose2(0.0, 0.0, 0.0))
    driven = noise.carry(Pose2(1.0, 0.0, 0.0))
    # Both wheels have miscounted on 1 m.
    assert driven[0, 0] == pytest.approx(0.002**2 / 2.0)
    assert driven[2, 2] == pytest.approx(2.0 * 0.002**2 / WHEEL_DISTANCE_M**2)
    assert np.array_equal(noise.carry(Pose2(1.0, 0.0, 0.0)), driven)
