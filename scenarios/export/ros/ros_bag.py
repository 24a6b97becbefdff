"""MCAP: a ROS 2 bag for each run, for `ros2 bag`, Foxglove and rerun: RUN/RUN.mcap and RUN/metadata.yaml."""

import time
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.formats import need
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.folder import further_cameras

if TYPE_CHECKING:
    from peopleboy.scenarios.export.ros.message_types import RosDistro

# Metadata version of Iron. Later distributions read it, and so does Humble, which fails at version 9.
_VERSION: Final = 8
_ONCE: Final = ("/tf_static", "/robot_description")
_LATEST_S: Final = 2**31  # end of the signed 32-bit seconds of ROS stamps


def write_mcap(
    runs: Sequence[FinishedRun], folder: Path, play: Play, epoch: str = "0", ros_distro: "RosDistro" = "jazzy"
) -> None:
    """Write a bag for each run.

    Args:
        runs: the runs to write.
        folder: output folder.
        play: returns the ticks of a run.
        epoch: start of the timestamps; see `epoch_ns`.
        ros_distro: ROS distribution of the message types.

    Raises:
        BadInput: the package that writes bags is not installed, or the epoch is invalid.
    """
    need("rosbags", "--format mcap")
    start_ns = epoch_ns(epoch)
    for run in runs:
        _write_bag(run, folder / run.name, play, start_ns, ros_distro)


def epoch_ns(epoch: str) -> int:
    """Return the start of the timestamps in nanoseconds since 1970.

    Args:
        epoch: "0", "now", or a date and time as in ISO 8601, in UTC unless it has another time zone.

    Raises:
        BadInput: the epoch is none of these, before 1970, or after January 2038.
    """
    if epoch == "0":
        return 0
    if epoch == "now":
        return time.time_ns()
    try:
        given = datetime.fromisoformat(epoch)
    except ValueError as error:
        raise BadInput(
            f"--epoch {epoch}: not a time; give 0, now, or a time such as 2026-05-01T12:00:00Z"
        ) from error
    seconds = (given if given.tzinfo else given.replace(tzinfo=UTC)).timestamp()
    if not 0 <= seconds < _LATEST_S:
        raise BadInput(f"--epoch {epoch}: is outside the range of ROS times, 1970 to January 2038")
    return round(seconds * 1e6) * 1000  # datetime resolves microseconds


def _write_bag(run: FinishedRun, folder: Path, play: Play, start_ns: int, distro: "RosDistro") -> None:
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

    from peopleboy.scenarios.export.ros.image_messages import image_messages
    from peopleboy.scenarios.export.ros.message_types import build, message_types, nanoseconds, stamp
    from peopleboy.scenarios.export.ros.people_messages import PeopleMessages
    from peopleboy.scenarios.export.ros.robot_messages import RobotMessages

    types = message_types(distro)
    cameras = run.robot.cameras
    robot, people = RobotMessages(run.robot), PeopleMessages([*cameras], further_cameras(cameras))
    bag = Writer(folder, version=_VERSION, storage_plugin=StoragePlugin.MCAP)
    bag.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    topics: dict[str, Any] = {}
    with bag:
        for tick in play(run):
            time_ns = start_ns + nanoseconds(tick.observation.time_s)
            clock = ("/clock", "rosgraph_msgs/Clock", {"clock": stamp(time_ns)})
            for topic, name, content in (
                *(() if topics else robot.fixed(time_ns)),
                clock,
                *image_messages(cameras, tick.observation.images, time_ns),
                *people.messages(tick, time_ns),
                *robot.messages(tick, time_ns),
            ):
                kind = name.replace("/", "/msg/")
                if topic not in topics:
                    topics[topic] = bag.add_connection(
                        topic, kind, typestore=types, offered_qos_profiles=_quality(topic)
                    )
                bag.write(topics[topic], time_ns, types.serialize_cdr(build(types, kind, content), kind))


def _quality(topic: str) -> tuple[Any, ...]:
    """Return the QoS profile of a topic; messages that are sent once reach late subscribers too."""
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

    is_once = topic in _ONCE
    ever = QosTime(9223372036, 854775807)  # RMW_DURATION_INFINITE
    profile = Qos(
        history=QosHistory.KEEP_LAST,
        depth=1 if is_once else 10,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if is_once else QosDurability.VOLATILE,
        deadline=ever,
        lifespan=ever,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=ever,
        avoid_ros_namespace_conventions=False,
    )
    return (profile,)
