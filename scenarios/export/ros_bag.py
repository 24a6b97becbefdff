"""MCAP: a ROS 2 bag for each run, for `ros2 bag`, Foxglove and rerun: RUN/RUN.mcap and RUN/metadata.yaml."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from peopleboy.scenarios.export.formats import need
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.run_folder.finished_run import FinishedRun

# Of the bag's metadata: Iron's. Later distributions read it too, and Humble, which fails at version 9.
_VERSION: Final = 8


def write_mcap(runs: Sequence[FinishedRun], folder: Path, play: Play) -> None:
    """Write a bag for each run.

    Raises:
        BadInput: the package that writes bags is not installed.
    """
    need("rosbags", "mcap")
    for run in runs:
        _write_bag(run, folder / run.name, play)


def _write_bag(run: FinishedRun, folder: Path, play: Play) -> None:
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

    from peopleboy.scenarios.export.ros_messages import RosMessages, message_types, nanoseconds

    types = message_types()
    messenger = RosMessages(run.robot, types)
    bag = Writer(folder, version=_VERSION, storage_plugin=StoragePlugin.MCAP)
    bag.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    topics: dict[str, Any] = {}
    with bag:
        for tick in play(run):
            time_s = tick.observation.time_s
            for topic, kind, content in (*(() if topics else messenger.fixed(time_s)), *messenger.tick(tick)):
                if topic not in topics:
                    topics[topic] = bag.add_connection(
                        topic, kind, typestore=types, offered_qos_profiles=_quality(topic)
                    )
                bag.write(topics[topic], nanoseconds(time_s), types.serialize_cdr(content, kind))


def _quality(topic: str) -> tuple[Any, ...]:
    """Let whoever comes late still get what is said only once."""
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

    is_once = topic == "/tf_static"
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
