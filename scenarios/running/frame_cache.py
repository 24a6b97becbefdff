"""Cache rendered frames on disk, so that all trackers get the same frames and each is rendered only once.

A sequence stores the images of `thermal` and `colour`, which trackers use. Images of other cameras are not
stored, but a change of any camera makes a new sequence.
"""

import hashlib
import json
import logging
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import asdict, astuple, dataclass, field
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from peopleboy import sim
from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.scenarios.run_folder.atomic_output import atomic, writing_to
from peopleboy.scenarios.run_folder.folder import gt_lines, versions
from peopleboy.scenarios.run_folder.run_files import true_boxes
from peopleboy.scenarios.run_folder.run_tables import TRUTH, truth_rows, with_metadata
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.observation import Observation
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.frame import Frame, Odometry
from peopleboy.tracker.track import Track
from peopleboy.user_files import read_json

MOTION = ("advance_m", "aside_m", "turn_rad")
SEEN = ("thermal", "colour")  # cameras whose images are cached
_GROUP = 16  # frames that are read or written together
_FRAMES = with_metadata(
    pa.schema(
        [
            pa.field("time_s", pa.float64()),
            *(pa.field(name, pa.float64()) for name in MOTION),
            *(pa.field(camera, pa.binary()) for camera in SEEN),
        ]
    ),
    "frames",
)


_LOG = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Film:
    """Frames and ground truth of one run on disk.

    Attributes:
        folder: folder with frames.parquet, truth.parquet and gt.txt.
        scenario: name of the scenario.
        seed: seed of the run.
        frames: number of frames.
        shapes: image shapes by camera: (height, width) or (height, width, 3) [px].
        calibrations: calibrations of the cameras.
    """

    folder: Path
    scenario: str
    seed: int
    frames: int
    shapes: Mapping[str, tuple[int, ...]]
    calibrations: Mapping[str, Calibration] = field(compare=False)

    def truth(self, boxes: BoxKind = BoxKind.TORSO) -> TrueBoxes:
        """Read the ground truth for the evaluation, with boxes around torsos or whole people."""
        return true_boxes(self.folder / "gt.txt", self.folder / "truth.parquet", boxes)

    def people(self) -> pa.Table:
        """Read the whole ground truth: one row per frame and person (`run_folder.run_tables.TRUTH`)."""
        return pq.read_table((self.folder / "truth.parquet").absolute())


def film(
    scenario: str | Path | Scenario, seed: int, folder: Path, report: Callable[[int, int], None] | None = None
) -> Film:
    """Return the cached frames of a run, rendering them if necessary.

    Cached frames are used only if scenario, seed, packages and simulator source are the same. An unfinished
    sequence is rendered again; several processes may render the same one.

    Args:
        scenario: a name, a path or a loaded scenario, whose robot does not depend on a tracker.
        seed: seed of the run.
        folder: cache folder, with one subfolder per sequence.
        report: called with the number of frames rendered and the total.

    Raises:
        BadInput: the robot follows tracked people, and has no recorded drive.
    """
    scenario = load_scenario(scenario)
    if scenario.needs_tracker:
        raise BadInput(
            f"{scenario.name}: its robot depends on a tracker, so its frames cannot be cached; "
            "give a scenario whose robot stands or is scripted"
        )
    home = folder / f"{scenario.name}-{seed}-{film_key(scenario, seed)[:12]}"
    if (home / "about.json").is_file():
        _LOG.info("frames of %s, seed %d, are cached in %s", scenario.name, seed, home)
    else:
        _LOG.info("rendering the frames of %s, seed %d", scenario.name, seed)
        _shoot(scenario, seed, home, report)
    return open_film(home)


def open_film(folder: Path) -> Film:
    """Open a finished sequence by its folder.

    Raises:
        BadInput: the folder does not contain one.
    """
    try:
        about = read_json(folder / "about.json")
    except (OSError, ValueError) as error:
        raise BadInput(f"{folder}: contains no complete frames") from error
    shapes = {camera: tuple(shape) for camera, shape in about.pop("shapes").items()}
    calibrations = {
        camera: PinholeCalibration(*(np.array(matrix) for matrix in matrices))
        for camera, matrices in about.pop("calibrations").items()
    }
    return Film(folder=folder, shapes=shapes, calibrations=calibrations, **about)


def frames_of(shot: Film, cameras: Collection[str] = SEEN) -> Iterator[Frame]:
    """Yield the frames, byte-identical to those of the run; only a few are in memory at a time.

    Args:
        shot: the cached sequence.
        cameras: cameras whose images to read; cameras that are not cached are ignored.
    """
    wanted = {camera: shape for camera, shape in shot.shapes.items() if camera in cameras}
    columns = ["time_s", *MOTION, *wanted]
    file = pq.ParquetFile((shot.folder / "frames.parquet").absolute())
    for batch in file.iter_batches(batch_size=_GROUP, columns=columns):
        for row in batch.to_pylist():
            images = {camera: _unpack(row[camera], shape) for camera, shape in wanted.items()}
            motion = {name: row[name] for name in MOTION}
            yield Frame(
                images=images,
                calibrations=shot.calibrations,
                time_s=row["time_s"],
                odometry=None if row["turn_rad"] is None else Odometry(**motion),
            )


def film_key(scenario: Scenario, seed: int) -> str:
    """Return a hash of everything that the frames depend on."""
    drive = [] if scenario.drive is None else [astuple(command) for command in scenario.drive]
    files = {name: hashlib.sha256(content).hexdigest() for name, content in scenario.files.items()}
    parts = [_FRAMES.names, scenario.resolved(seed), seed, versions(), _source_digest(), drive, files]
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


class _Blind:
    """A tracker that never returns a track."""

    cameras = SEEN

    def update(self, frame: Frame) -> tuple[Track, ...]:  # noqa: ARG002
        return ()


def _shoot(scenario: Scenario, seed: int, home: Path, report: Callable[[int, int], None] | None) -> None:
    """Render a sequence next to its final place, and move it there when it is complete."""
    with atomic(home, stays=(home / "about.json").is_file) as part:  # another process may finish first
        with writing_to(home.parent, "--frame-cache"):
            part.mkdir(parents=True)
        about = _render(scenario, seed, part, report)
        (part / "about.json").write_text(json.dumps(about) + "\n", encoding="utf-8")


def _render(
    scenario: Scenario, seed: int, part: Path, report: Callable[[int, int], None] | None
) -> dict[str, Any]:
    from peopleboy.sim.world import SimulatedWorld  # here, so that cached frames can be read without PyBullet

    config = scenario.world(seed)
    count = scenario.frames
    with (
        SimulatedWorld(config) as world,
        pq.ParquetWriter((part / "frames.parquet").absolute(), _FRAMES, compression="zstd") as frames,
        pq.ParquetWriter((part / "truth.parquet").absolute(), TRUTH, compression="zstd") as truth,
        (part / "gt.txt").open("w", encoding="utf-8", newline="\n") as boxes,
    ):
        before = None
        images: list[dict[str, Any]] = []
        people: list[dict[str, Any]] = []
        for tick in closed_loop(world, _Blind(), scenario.make_behaviour(), count):
            images.append(_row(tick.observation, Frame.from_observation(tick.observation, before, {})))
            people += truth_rows(tick)
            boxes.writelines(gt_lines(tick))
            before = tick.observation.odometry
            if len(images) == _GROUP or tick.frame == count:
                frames.write_table(pa.Table.from_pylist(images, schema=_FRAMES))
                truth.write_table(pa.Table.from_pylist(people, schema=TRUTH))
                images.clear()
                people.clear()
            if report is not None:
                report(tick.frame, count)
    shapes = {camera: tick.observation.images[camera].shape for camera in SEEN}
    cameras = {name: flat_geometry(config.robot.cameras, name) for name in SEEN}
    calibrations = {
        name: [camera.intrinsics.tolist(), camera.robot_from_camera.tolist()]
        for name, camera in cameras.items()
    }
    return {
        "scenario": scenario.name,
        "seed": seed,
        "frames": count,
        "shapes": shapes,
        "calibrations": calibrations,
    }


def _row(senses: Observation, frame: Frame) -> dict[str, Any]:
    motion = dict.fromkeys(MOTION) if frame.odometry is None else asdict(frame.odometry)
    return {"time_s": frame.time_s} | motion | {camera: _pack(senses.images[camera]) for camera in SEEN}


def _pack(image: NDArray[np.uint8]) -> bytes:
    """Encode an image as differences between its rows, which compress better than the rows."""
    rows = image.copy()
    rows[1:] -= image[:-1]
    return rows.tobytes()


def _unpack(packed: bytes, shape: tuple[int, ...]) -> NDArray[np.uint8]:
    image: NDArray[np.uint8] = np.frombuffer(packed, dtype=np.uint8).reshape(shape).copy()
    # Row by row is three times as fast as np.cumsum.
    for above, row in pairwise(image):
        np.add(above, row, out=row)
    return image


@cache
def _source_digest() -> str:
    """Return a hash of the simulator's source, which may change within a version."""
    digest = hashlib.sha256()
    for path in sorted(Path(sim.__path__[0]).rglob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()
