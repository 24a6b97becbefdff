"""Define the parquet tables of a run: truth, tracks, robot and objects, with one row per frame and entity."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from importlib.metadata import version
from operator import attrgetter
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgpack
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray
from pyarrow.fs import LocalFileSystem

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.loop.loop import BlindTick, Tick
from peopleboy.scenarios.run_folder.atomic_output import PART
from peopleboy.scenarios.run_folder.image_files import millimetres
from peopleboy.sim.truth.truth import Truth
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.reproductions.contour.explanation import ContourExplanation, Ellipse
from peopleboy.tracker.reproductions.contour.variants import VARIANTS
from peopleboy.tracker.track import Box, FloorPlace, Status, Track, TrackPosture
from peopleboy.tracker.tracking.sensor import parts_of

STATE = ("x", "y", "w", "h", "d", "vx", "vy", "vw", "vh")
SPREAD = "uncertainty_px2"
COLUMNS = (SPREAD, *STATE)
"""Columns of the tracks table that are empty for trackers without contours."""

_NOTHING: Mapping[str, Any] = dict.fromkeys(COLUMNS)


def explained(explanation: object, track: int) -> Mapping[str, Any]:
    """Return the values of `COLUMNS` for a track; None if the explanation has no contours."""
    if isinstance(explanation, ContourExplanation) and track in explanation.ellipses:
        return {SPREAD: explanation.spread_px2[track], **asdict(explanation.ellipses[track])}
    found = (explained(part, track) for part in parts_of(explanation))
    return next((values for values in found if values is not _NOTHING), _NOTHING)


def read_explanation(tracker: str, rows: Iterable[Mapping[str, Any]]) -> ContourExplanation | None:
    """Return a tracker's explanation at one frame, read from its rows; None if they contain none."""
    explained_rows = [row for row in rows if row[SPREAD] is not None]
    if not explained_rows or tracker not in VARIANTS:
        return None
    return ContourExplanation(
        config=VARIANTS[tracker],
        ellipses={row["id"]: Ellipse(**{name: row[name] for name in STATE}) for row in explained_rows},
        spread_px2={row["id"]: row[SPREAD] for row in explained_rows},
    )


Row = dict[str, Any]


class TableColumn(NamedTuple):
    """One column of a table.

    Attributes:
        type: type of the values.
        value: returns the value for the entity of a row.
        may_be_empty: whether rows may lack a value.
    """

    type: pa.DataType
    value: Callable[[Any], Any]
    may_be_empty: bool = False


TableColumns = Mapping[str, TableColumn]

INT, FLOAT, BOOL, STRING = pa.int64(), pa.float64(), pa.bool_(), pa.string()
_SHARES = pa.map_(pa.string(), pa.float64())
_INSTANT = [pa.field("frame", INT), pa.field("time_s", FLOAT)]

PLACE: Final = ("place_x_m", "place_y_m", "place_xx_m2", "place_xy_m2", "place_yy_m2")
_EDGES = ("left_px", "top_px", "width_px", "height_px")


def plain(kind: pa.DataType, *names: str) -> TableColumns:
    """Declare columns whose values are attributes of the same name."""
    return {name: TableColumn(kind, attrgetter(name)) for name in names}


def numbers(
    names: Iterable[str], values: Callable[[Any], Sequence[float] | None], *, may_be_empty: bool = False
) -> TableColumns:
    """Declare a column for each number of a tuple; all are empty if there is no tuple."""

    def nth(k: int) -> Callable[[Any], float | None]:
        return lambda one: None if (found := values(one)) is None else found[k]

    return {name: TableColumn(FLOAT, nth(k), may_be_empty) for k, name in enumerate(names)}


def box(prefix: str, attribute: str) -> TableColumns:
    """Declare the columns of a box."""
    return numbers((f"{prefix}{edge}" for edge in _EDGES), attrgetter(attribute), may_be_empty=True)


_UNITS: Final = {
    "_m_s": "m/s",
    "_rad_s": "rad/s",
    "_px2": "px2",
    "_m2": "m2",
    "_px": "px",
    "_rad": "rad",
    "_m": "m",
    "_s": "s",
    "_c": "degC",
}
"""Units by the suffix of a column's name, longer suffixes first."""

FRAMES: Final = {
    "world": "right-handed, z up; origin and axes of the scenario's plan",
    "robot": "x forward, y left, z up; origin on the floor below the robot's axis",
    "image": "u right, v down; the middle of the upper left pixel is (0, 0)",
}
"""Reference frames of columns."""

_IN_WORLD: Final = ("x_m", "y_m", "z_m", "heading_rad", "velocity_", "joints_m", "odometry_")


def _about(name: str) -> dict[str, str]:
    """Return unit and reference frame of a column, from its name."""
    unit = next((unit for end, unit in _UNITS.items() if name.endswith(end)), "")
    frame = "image" if unit in ("px", "px2") else "robot" if name.startswith("place_") else ""
    if name.startswith(_IN_WORLD):
        frame = frame or "world"
    return {key: value for key, value in (("unit", unit), ("frame", frame)) if value}


def with_metadata(schema: pa.Schema, table: str) -> pa.Schema:
    """Return a schema with metadata: unit and frame of each column, and the program that wrote the table."""
    fields = [field.with_metadata(_about(field.name) or None) for field in schema]
    frames = {f"peopleboy.frame.{name}": text for name, text in FRAMES.items()}
    return pa.schema(fields, {"peopleboy.table": table, "peopleboy.version": version("peopleboy"), **frames})


def schema_of(table: str, columns: TableColumns) -> pa.Schema:
    """Return the schema of a table with these columns after frame and time."""
    fields = (pa.field(name, column.type) for name, column in columns.items())
    return with_metadata(pa.schema([*_INSTANT, *fields]), table)


def row_of(columns: TableColumns, frame: int, time_s: float, one: object) -> Row:
    """Return the row of a table about one person, object, track or robot."""
    values = {name: column.value(one) for name, column in columns.items()}
    return {"frame": frame, "time_s": time_s, **values}


_PERSON: Final[TableColumns] = {
    **plain(INT, "id"),
    **plain(STRING, "name"),
    **numbers(("x_m", "y_m"), attrgetter("position_m")),
    **plain(FLOAT, "heading_rad"),
    **numbers(("velocity_x_m_s", "velocity_y_m_s"), attrgetter("velocity_m_s")),
    **plain(FLOAT, "distance_m"),
    **plain(STRING, "posture"),
    **plain(BOOL, "is_counted"),
    **box("", "box"),
    **box("whole_", "whole_box"),
    **box("visible_", "visible_box"),
    **plain(INT, "whole_px", "visible_px"),
    **plain(FLOAT, "visible_fraction", "occluded_fraction"),
    "occluder": TableColumn(STRING, attrgetter("occluder"), True),
    "hidden_by": TableColumn(_SHARES, lambda person: dict(person.hidden_by)),
    "part_temperature_c": TableColumn(_SHARES, lambda person: dict(person.part_temperature_c)),
    "joints_m": TableColumn(pa.list_(FLOAT, 51), lambda person: person.joints_m.ravel().tolist()),
    "joints_px": TableColumn(pa.list_(FLOAT, 34), lambda person: person.joints_px.ravel().tolist()),
    "joint_is_visible": TableColumn(pa.list_(BOOL, 17), lambda person: person.joint_is_visible.tolist()),
}


class _Tracked(NamedTuple):
    """A track, its box in one camera's image, and its tracker's explanation, by `COLUMNS`."""

    track: Track
    box: Box | None
    explained: Mapping[str, Any]

    @property
    def place(self) -> tuple[float, ...] | None:
        place = self.track.place
        return None if place is None else (*place.position_m, *place.covariance_m2)


def _explained(name: str) -> TableColumn:
    return TableColumn(FLOAT, lambda one: one.explained[name], True)


_TRACK: Final[TableColumns] = {
    "id": TableColumn(INT, attrgetter("track.id")),
    "status": TableColumn(STRING, lambda one: str(one.track.status)),
    "confidence": TableColumn(FLOAT, attrgetter("track.confidence")),
    "age_s": TableColumn(FLOAT, attrgetter("track.age_s")),
    SPREAD: _explained(SPREAD),
    **box("", "box"),
    **numbers(PLACE, attrgetter("place"), may_be_empty=True),
    **{name: _explained(name) for name in STATE},
    "occluder": TableColumn(INT, attrgetter("track.occluder"), True),
    "posture": TableColumn(STRING, attrgetter("track.posture"), True),
}

_THING: Final[TableColumns] = {
    **plain(STRING, "name"),
    **numbers(("x_m", "y_m", "z_m"), attrgetter("position_m")),
    **plain(FLOAT, "heading_rad"),
    **plain(BOOL, "is_there", "is_moving"),
    **plain(STRING, "moved_by"),
    **plain(INT, "visible_px"),
    **box("", "visible_box"),
}

_ROBOT: Final[TableColumns] = {
    **numbers(
        ("x_m", "y_m", "heading_rad"), attrgetter("truth.robot.x", "truth.robot.y", "truth.robot.heading")
    ),
    **numbers(("linear_m_s", "angular_rad_s"), attrgetter("truth.robot_velocity")),
    "odometry_x_m": TableColumn(FLOAT, attrgetter("observation.odometry.x")),
    "odometry_y_m": TableColumn(FLOAT, attrgetter("observation.odometry.y")),
    "odometry_heading_rad": TableColumn(FLOAT, attrgetter("observation.odometry.heading")),
    **numbers(("left_wheel_m_s", "right_wheel_m_s"), attrgetter("observation.wheel_speeds_m_s")),
    "command_linear_m_s": TableColumn(FLOAT, attrgetter("command.linear_m_s")),
    "command_angular_rad_s": TableColumn(FLOAT, attrgetter("command.angular_rad_s")),
    "command_is_emergency": TableColumn(BOOL, attrgetter("command.is_emergency")),
    **plain(STRING, "mode"),
    "sonar_m": TableColumn(pa.list_(FLOAT, 16), lambda tick: tick.observation.sonar_m.tolist()),
    "contacts": TableColumn(pa.list_(STRING), lambda tick: list(tick.truth.contacts)),
}


class _Scan(NamedTuple):
    """A scan of a range finder (1, N) [mm], and the ground truth of the same instant."""

    ranges: NDArray[np.uint16]
    truth: Truth


_SCAN: Final[TableColumns] = {
    "range_m": TableColumn(pa.list_(FLOAT), lambda scan: _metres(scan.ranges[0])),
    "true_range_m": TableColumn(pa.list_(FLOAT), lambda scan: _metres(millimetres(scan.truth.depth_m)[0])),
    "person": TableColumn(pa.list_(INT), lambda scan: scan.truth.instance[0].tolist()),
}


def _metres(ranges: NDArray[np.uint16]) -> list[float | None]:
    """Return ranges in metres; None for no reading."""
    return [one / 1000.0 if one else None for one in ranges.tolist()]


TRUTH, TRACKS = schema_of("truth", _PERSON), schema_of("tracks", _TRACK)
ROBOT, THINGS = schema_of("robot", _ROBOT), schema_of("things", _THING)
SCANS: Final = schema_of("scans", _SCAN)

MAY_BE_EMPTY = frozenset(
    name for columns in (_PERSON, _TRACK) for name, column in columns.items() if column.may_be_empty
)
"""Columns that are empty if there is no person or object."""

EMPTY_TOGETHER = (*(tuple(box(prefix, "box")) for prefix in ("", "whole_", "visible_")), PLACE)
"""Columns that are empty in the same rows."""


def truth_rows(tick: Tick, camera: str = "thermal") -> list[Row]:
    """Return the rows of a camera's truth table for one tick: one per person present."""
    return [row_of(_PERSON, tick.frame, tick.truth.time_s, one) for one in tick.truths[camera].people]


def thing_rows(tick: Tick, camera: str) -> list[Row]:
    """Return the rows of the objects table for one tick, from a camera's ground truth."""
    return [row_of(_THING, tick.frame, tick.truth.time_s, one) for one in tick.truths[camera].things]


def scan_rows(tick: Tick, camera: str) -> list[Row]:
    """Return the row of a range finder's scan at one tick, with the person that each beam hits."""
    scan = _Scan(tick.observation.images[camera], tick.truths[camera])
    return [row_of(_SCAN, tick.frame, tick.truth.time_s, scan)]


def is_in_image(people: pa.Table) -> NDArray[np.bool_]:
    """Return whether any part of the silhouette lies inside the image (N,)."""
    outside = np.array([dict(shares).get("border", 0.0) for shares in people["hidden_by"].to_pylist()])
    return np.asarray((people["whole_px"].to_numpy() > 0) & (outside.reshape(-1) < 1.0))


def track_rows(tick: Tick) -> list[Row]:
    """Return the rows of the tracks table for one tick: one per track, including tentative ones."""
    return [track_row(tick.frame, tick.truth.time_s, track, tick.explanation) for track in tick.tracks]


def track_row(frame: int, time_s: float, track: Track, explanation: object, camera: str = THERMAL) -> Row:
    """Return the row of one track at one instant, with the tracker's explanation.

    The box is the one in the image of `camera`.
    """
    one = _Tracked(track, track.boxes.get(camera), explained(explanation, track.id))
    return row_of(_TRACK, frame, time_s, one)


def robot_row(tick: Tick | BlindTick) -> Row:
    """Return the row of the robot table for one tick."""
    return row_of(_ROBOT, tick.frame, tick.truth.time_s, tick)


def odometry_pose(row: Mapping[str, Any]) -> Pose2:
    """Return the pose by odometry from a row of the robot table."""
    return Pose2(row["odometry_x_m"], row["odometry_y_m"], row["odometry_heading_rad"])


LOCAL: Final = LocalFileSystem()
"""Without it, and with relative paths, pyarrow takes a path with a colon for a URI."""

_BLOCK_ROWS: Final = 512
_GROUP_ROWS: Final = 8192
_LOG: Final = "rows.log"


class TableFile:
    """Write a parquet file in groups of 8192 rows, so that memory does not grow with its length.

    It is written aside, and takes its name with `close`. Without rows, the table is empty and has the same
    columns.

    Args:
        path: the table.
        schema: its columns.
    """

    def __init__(self, path: Path, schema: pa.Schema) -> None:
        self._path, self._part = path, path.with_name(path.name + PART)
        self._schema = schema
        self._rows: list[Row] = []
        self._blocks: list[pa.Table] = []
        self._writer: pq.ParquetWriter | None = None

    @property
    def is_empty(self) -> bool:
        """Whether it has no rows."""
        return not (self._rows or self._blocks or self._writer)

    def add(self, rows: Iterable[Row]) -> None:
        """Append rows."""
        self._rows += rows
        if len(self._rows) >= _BLOCK_ROWS:
            self._pack()
            if sum(block.num_rows for block in self._blocks) >= _GROUP_ROWS:
                self._write_group()

    def close(self) -> None:
        """Write the remaining rows, and complete the file."""
        self._pack()
        if self._writer is None or any(block.num_rows for block in self._blocks):
            self._write_group()
        if self._writer is not None:
            self._writer.close()
        self._part.replace(self._path)

    def _pack(self) -> None:
        """Convert rows to columns, which take a tenth of the memory."""
        self._blocks.append(pa.Table.from_pylist(self._rows, schema=self._schema))
        self._rows = []

    def _write_group(self) -> None:
        if self._writer is None:
            self._writer = pq.ParquetWriter(str(self._part.absolute()), self._schema, filesystem=LOCAL)
        self._writer.write_table(pa.concat_tables(self._blocks).combine_chunks())
        self._blocks = []
        pa.default_memory_pool().release_unused()  # 100 MB, which pyarrow would keep for minutes


class RunTables:
    """Write all tables of a run as it goes; every frame is flushed to a log before it counts.

    The log has one record (msgpack) per frame: the rows of each table. It is removed when the tables are
    complete; what a killed process left is converted by `recover_tables`.

    Args:
        folder: folder of the run.
        cameras: cameras with ground truth.
        scanners: range finders.
    """

    def __init__(self, folder: Path, cameras: Iterable[str], scanners: Iterable[str] = ()) -> None:
        self._tables = _table_files(folder, cameras, scanners)
        self._path = folder / _LOG
        self._log = self._path.open("wb")
        self._pack = msgpack.Packer(default=_plain).pack

    def write(self, rows: Mapping[str, list[Row]]) -> None:
        """Write one frame: rows by table."""
        self._log.write(self._pack(rows))
        self._log.flush()
        _add(self._tables, rows)

    def save(self) -> None:
        """Complete the tables, and remove the log; a second call does nothing."""
        if not self._log.closed:
            _close(self._tables)
            self._log.close()
            self._path.unlink()


def recover_tables(folder: Path, cameras: Iterable[str], scanners: Iterable[str]) -> int:
    """Convert the log of a run whose process was killed, if there is one; return the number of frames.

    Raises:
        OSError: the folder cannot be written to.
        ValueError: log or table are damaged.
    """
    log, robot = folder / _LOG, folder / ROBOT_TABLE
    if not log.is_file():
        return pq.read_metadata(robot.absolute(), filesystem=LOCAL).num_rows if robot.is_file() else 0
    tables, frames = _table_files(folder, cameras, scanners), 0
    with log.open("rb") as file:
        for rows in msgpack.Unpacker(file):  # ends before a record that is incomplete
            _add(tables, rows)
            frames += 1
    _close(tables)
    log.unlink()
    return frames


ROBOT_TABLE: Final = "robot.parquet"
TRACKS_TABLE: Final = "tracks.parquet"
THINGS_TABLE: Final = "truth/things.parquet"
SCANS_FOLDER: Final = "scans"


def scan_table(camera: str) -> str:
    """Return the path of the table of a range finder's scans in the folder of a run."""
    return f"{SCANS_FOLDER}/{camera}.parquet"


def truth_table(camera: str) -> str:
    """Return the path of a camera's table of ground truth in the folder of a run."""
    return "truth.parquet" if camera == THERMAL else f"truth/{camera}.parquet"


def _table_files(folder: Path, cameras: Iterable[str], scanners: Iterable[str]) -> dict[str, TableFile]:
    schemas = {ROBOT_TABLE: ROBOT, TRACKS_TABLE: TRACKS, THINGS_TABLE: THINGS}
    schemas |= {truth_table(camera): TRUTH for camera in cameras}
    schemas |= {scan_table(camera): SCANS for camera in scanners}
    return {name: TableFile(folder / name, schema) for name, schema in schemas.items()}


def _add(tables: Mapping[str, TableFile], rows: Mapping[str, list[Row]]) -> None:
    for name, added in rows.items():
        tables[name].add(added)


def _close(tables: Mapping[str, TableFile]) -> None:
    for name, table in tables.items():
        if name != THINGS_TABLE or not table.is_empty:  # which only runs with moved objects have
            table.close()


def _plain(value: Any) -> Any:
    return value.item()  # of a NumPy scalar


def write_table(path: Path, rows: list[Row], schema: pa.Schema) -> None:
    """Write rows as a parquet file."""
    table = TableFile(path, schema)
    table.add(rows)
    table.close()


def track_of(row: Mapping[str, Any]) -> Track:
    """Return the track of a row of the tracks table."""
    left, top, width, height = (row[edge] for edge in _EDGES)
    x, y, *covariance = (row[name] for name in PLACE)
    return Track(
        id=row["id"],
        boxes={} if left is None else {THERMAL: (left, top, width, height)},
        place=None if x is None else FloorPlace(position_m=(x, y), covariance_m2=tuple(covariance)),
        confidence=row["confidence"],
        status=Status(row["status"]),
        age_s=row["age_s"],
        occluder=row["occluder"],
        posture=None if row["posture"] is None else TrackPosture(row["posture"]),
    )
