"""Read ground truth and tracks of a finished run, and check that the files are consistent.

A run of another version, or one whose files were changed later, is refused with a message of one line.
"""

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.run_tables import (
    EMPTY_TOGETHER,
    LOCAL,
    MAY_BE_EMPTY,
    PLACE,
    ROBOT,
    TRACKS,
    TRUTH,
    Row,
    is_in_image,
    read_explanation,
    track_of,
    truth_table,
)
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.floor import Places
from peopleboy.tracker.evaluation.mot_files import DetectionRows, read_detections, read_tracks, read_truth
from peopleboy.tracker.evaluation.sequence import Rows, TrackBoxes, TrueBoxes
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Box, Status, Track
from peopleboy.tracker.tracker_names import is_detection_file, split_name

_AGAIN = "run the scenario again"
_TRUTH_TEXT, _TRACKS_TEXT = Path("truth") / "gt.txt", Path("tracks.txt")
# Columns that select the rows of the tables that are also in the text files.
WRITTEN_TRUTH = ("frame", "id", "left_px", "whole_px", "hidden_by")
_WRITTEN_TRACKS = ("frame", "id", "status", "left_px")
_WHOLE = ("whole_left_px", "whole_top_px", "whole_width_px", "whole_height_px")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunFiles:
    """The tables of a run.

    Attributes:
        truth, tracks: truth/gt.txt and tracks.txt.
        further: tracks/CAMERA.txt by camera, for other cameras in which the tracker gave boxes.
        people, beliefs, robot: truth.parquet, tracks.parquet, robot.parquet.
    """

    truth: TrueBoxes
    tracks: TrackBoxes
    further: Mapping[str, TrackBoxes]
    people: pa.Table
    beliefs: pa.Table
    robot: pa.Table

    def people_by_frame(self) -> dict[int, list[Row]]:
        """Return the rows of truth.parquet by frame."""
        return _by_frame(self.people)

    def tracks_by_frame(self) -> dict[int, list[Track]]:
        """Return the tracks by frame, including tentative ones."""
        found = _by_frame(self.beliefs).items()
        boxes = self._further_boxes()
        return defaultdict(
            list,
            {
                frame: [_with_boxes(track_of(row), boxes[frame, row["id"]]) for row in rows]
                for frame, rows in found
            },
        )

    def _further_boxes(self) -> dict[tuple[int, int], dict[str, Box]]:
        """Return the boxes in other cameras' images, by frame and id."""
        found: dict[tuple[int, int], dict[str, Box]] = defaultdict(dict)
        for camera, rows in self.further.items():
            columns = (rows.frame.tolist(), rows.id.tolist(), rows.box.tolist())
            for frame, number, (left, top, width, height) in zip(*columns, strict=True):
                found[frame, number][camera] = (left, top, width, height)
        return found

    def explanations_by_frame(self, tracker: str) -> dict[int, object]:
        """Return the tracker's explanations by frame, as far as the table stores them; None for none."""
        found = _by_frame(self.beliefs).items()
        return defaultdict(lambda: None, {frame: read_explanation(tracker, rows) for frame, rows in found})


def read_files(
    folder: Path,
    frames: int,
    people: Sequence[str] = TRUTH.names,
    robot: Sequence[str] = ROBOT.names,
) -> RunFiles:
    """Read the tables of a run.

    Args:
        folder: folder of the run.
        frames: number of frames of the run.
        people: columns to read from truth.parquet, including those that mark people in the image.
        robot: columns to read from robot.parquet, including `frame`.

    Raises:
        BadInput: a file is missing or damaged, lacks a column, or does not belong to the others.
    """
    files = RunFiles(
        truth=read_truth(folder / _TRUTH_TEXT),
        tracks=read_tracks(folder / _TRACKS_TEXT),
        further={path.stem: read_tracks(path) for path in sorted((folder / "tracks").glob("*.txt"))},
        people=read_table(folder / "truth.parquet", TRUTH, people),
        beliefs=read_table(folder / "tracks.parquet", TRACKS, TRACKS.names),
        robot=read_table(folder / "robot.parquet", ROBOT, robot),
    )
    check_robot(folder, files.robot, frames)
    for name in set(pc.unique(files.beliefs["status"]).to_pylist()) - set(Status):
        raise BadInput(f"{folder / 'tracks.parquet'}: unknown status {name!r}; {_AGAIN}")
    check_end(files.truth, folder / _TRUTH_TEXT, frames)
    check_end(files.tracks, folder / _TRACKS_TEXT, frames)
    _check_rows(files.truth, folder / _TRUTH_TEXT, written_truth(files.people))
    _check_rows(files.tracks, folder / _TRACKS_TEXT, _written_tracks(files.beliefs))
    return files


def check_robot(folder: Path, robot: pa.Table, frames: int) -> None:
    """Refuse a robot.parquet that has not one row for each frame.

    Raises:
        BadInput: a frame is missing or superfluous.
    """
    if robot.num_rows != frames or robot["frame"].to_pylist() != list(range(1, frames + 1)):
        raise BadInput(
            f"{folder / 'robot.parquet'}: must have a row for each of the {frames} frames, "
            f"got {robot.num_rows}; {_AGAIN}"
        )


def check_whole(folder: Path, truth: TrueBoxes, tracks: TrackBoxes) -> None:
    """Refuse a run whose text files and tables do not contain the same boxes; missing tables are ignored.

    Args:
        folder: folder of the run.
        truth: contents of truth/gt.txt.
        tracks: contents of tracks.txt.

    Raises:
        BadInput: a box is missing or superfluous, or a table is damaged.
    """
    if (folder / "truth.parquet").is_file():
        people = read_table(folder / "truth.parquet", TRUTH, WRITTEN_TRUTH)
        _check_rows(truth, folder / _TRUTH_TEXT, written_truth(people))
    if (folder / "tracks.parquet").is_file():
        beliefs = read_table(folder / "tracks.parquet", TRACKS, _WRITTEN_TRACKS)
        _check_rows(tracks, folder / _TRACKS_TEXT, _written_tracks(beliefs))


def check_end(rows: Rows | DetectionRows, path: Path, frames: int) -> None:
    """Refuse a file with frames beyond the end of the run.

    Raises:
        BadInput: the file has such frames.
    """
    if rows.last_frame > frames:
        raise BadInput(f"{path}: must end with frame {frames}, the run's last, got {rows.last_frame}")


def check_detections(tracker: str, frames: int) -> None:
    """Refuse a tracker's file of detections, if it uses one, with frames beyond the end of the run.

    Raises:
        BadInput: the file has such frames, or is malformed.
    """
    detector = split_name(tracker)[1]
    if detector is not None and is_detection_file(detector):
        check_end(read_detections(Path(detector)), Path(detector), frames)


def read_table(path: Path, schema: pa.Schema, columns: Collection[str]) -> pa.Table:
    """Read columns of a table of a run.

    Raises:
        BadInput: the table is missing, damaged, or of a version with other columns.
    """
    try:
        found = pq.read_schema(path.absolute(), filesystem=LOCAL)
        for name in columns:
            if name not in found.names:
                raise BadInput(f"{path}: has no column {name!r}; {_AGAIN}")
            was, must = found.field(name).type, schema.field(name).type
            if was != must:
                raise BadInput(f"{path}: column {name!r} must be {must}, got {was}; {_AGAIN}")
        table = pq.read_table(path.absolute(), columns=list(columns), filesystem=LOCAL)
    except (OSError, pa.ArrowException, UnicodeDecodeError) as error:
        raise BadInput(f"{path}: cannot be read as a table of a run; {_AGAIN}") from error
    for name in columns:
        if table[name].null_count and name not in MAY_BE_EMPTY:
            raise BadInput(f"{path}: column {name!r} has rows without a value; {_AGAIN}")
    for group in EMPTY_TOGETHER:
        first, *others = [name for name in group if name in table.column_names] or [""]
        for name in others:
            if not table[name].is_null().equals(table[first].is_null()):
                raise BadInput(f"{path}: {first!r} and {name!r} must be empty in the same rows; {_AGAIN}")
    return table


def truth_files(folder: Path, camera: str) -> tuple[Path, Path]:
    """Return the paths of the text and the table of a camera's ground truth in a run's folder."""
    text = "gt.txt" if camera == THERMAL else f"{camera}.gt.txt"
    return folder / "truth" / text, folder / truth_table(camera)


OCCLUDED: Final = ("frame", "id", "occluded_fraction")
"""Columns of the ground truth that state how much of a person is occluded."""


def occluded_shares(people: pa.Table, truth: TrueBoxes) -> Floats:
    """Return the occluded share of each row of a truth (N,) from a table of the same people; NaN for none."""
    rows = zip(*(people[name].to_pylist() for name in OCCLUDED), strict=True)
    share = {(frame, person): occluded for frame, person, occluded in rows}
    keys = zip(truth.frame.tolist(), truth.id.tolist(), strict=True)
    return np.array([share.get(key, np.nan) for key in keys], dtype=np.float64)


def true_boxes(text: Path, table: Path, kind: BoxKind) -> TrueBoxes:
    """Read the ground truth: torso boxes are in the text file, whole-person boxes only in the table.

    A whole-person box is the box of the unoccluded silhouette, which may extend beyond the image.

    Raises:
        BadInput: a file is missing or damaged.
    """
    if kind is BoxKind.TORSO:
        return read_truth(text)
    columns = (*WRITTEN_TRUTH, "is_counted", "visible_fraction", *_WHOLE)
    people = written_truth(read_table(table, TRUTH, columns))
    people = people.filter(people["whole_left_px"].is_valid())
    return TrueBoxes(
        frame=people["frame"].to_numpy(),
        id=people["id"].to_numpy(),
        box=np.stack([people[name].to_numpy() for name in _WHOLE], axis=-1),
        counted=people["is_counted"].to_numpy(zero_copy_only=False),
        visible=people["visible_fraction"].to_numpy(),
    )


def written_truth(people: pa.Table) -> pa.Table:
    """Return the rows of people who have a line in truth/gt.txt."""
    return people.filter(pc.and_(pa.array(is_in_image(people)), pc.is_valid(people["left_px"])))


def _written_tracks(beliefs: pa.Table) -> pa.Table:
    """Return the rows of tracks that have a line in tracks.txt."""
    is_sure = pc.not_equal(beliefs["status"], str(Status.TENTATIVE))
    return beliefs.filter(pc.and_(is_sure, pc.is_valid(beliefs["left_px"])))


def _with_boxes(track: Track, boxes: Mapping[str, Box]) -> Track:
    return replace(track, boxes={**track.boxes, **boxes}) if boxes else track


def _by_frame(table: pa.Table) -> dict[int, list[Row]]:
    found: dict[int, list[Row]] = defaultdict(list)
    for row in table.to_pylist():
        found[row["frame"]].append(row)
    return found


def _check_rows(rows: Rows, path: Path, table: pa.Table) -> None:
    """Refuse a text file with an incomplete line, or whose frames and ids differ from those of the table."""
    if len(rows) and not path.read_bytes().endswith(b"\n"):
        raise BadInput(f"{path}: ends in the middle of a line; {_AGAIN}")
    said = set(zip(rows.frame.tolist(), rows.id.tolist(), strict=True))
    known = set(zip(table["frame"].to_pylist(), table["id"].to_pylist(), strict=True))
    for frame, number in sorted(said - known)[:1]:
        raise BadInput(f"{path}: frame {frame}: id {number} is not in the run's tables; {_AGAIN}")
    for frame, number in sorted(known - said)[:1]:
        raise BadInput(
            f"{path}: has {len(said & known)} of the {len(known)} boxes in the run's tables, the first "
            f"that is missing is id {number} in frame {frame}; {_AGAIN}"
        )


POSE: Final = ("frame", "x_m", "y_m", "heading_rad")
VIEW: Final = ("frame", "id", "visible_fraction", "is_counted")
PEOPLE: Final = (*VIEW, "x_m", "y_m")
BELIEFS: Final = ("frame", "id", "confidence", "status", "left_px", *PLACE)
"""Columns of robot.parquet, truth.parquet and tracks.parquet that are needed here."""


def places_of_people(people: pa.Table, robot: pa.Table) -> Places:
    """Return the floor positions of people.

    Raises:
        BadInput: the robot's position is missing in a frame.
    """
    frame, poses = people["frame"].to_numpy(), _columns(robot, POSE)
    if not np.isin(frame, poses[:, 0]).all():
        raise BadInput("truth.parquet: has frames that are not in robot.parquet; run the scenario again")
    x, y, heading = poses[np.searchsorted(poses[:, 0], frame), 1:].T
    dx, dy = people["x_m"].to_numpy() - x, people["y_m"].to_numpy() - y
    cosine, sine = np.cos(heading), np.sin(heading)
    seen = np.stack([dx * cosine + dy * sine, dy * cosine - dx * sine], axis=-1)
    return Places(frame=frame, id=people["id"].to_numpy(), position_m=seen)


def places_of_tracks(beliefs: pa.Table) -> Places:
    """Return the floor positions of confirmed tracks that have one."""
    placed = _placed(beliefs)
    columns = _columns(placed, PLACE)
    return Places(
        frame=placed["frame"].to_numpy(),
        id=placed["id"].to_numpy(),
        position_m=columns[:, :2],
        covariance_m2=columns[:, 2:],
    )


def is_on_floor_alone(beliefs: pa.Table) -> bool:
    """Return whether a tracker gave floor positions of people, but no boxes in the thermal image."""
    return bool(len(beliefs)) and beliefs["left_px"].null_count == len(beliefs) and len(_placed(beliefs)) > 0


def as_squares(
    folder: Path, people: pa.Table, beliefs: pa.Table, robot: pa.Table
) -> tuple[TrueBoxes, TrackBoxes]:
    """Replace the boxes of all present people and of confirmed tracks by squares on the floor [m].

    Which people count, and their visible fraction, is determined by the cameras in which the tracker gave
    boxes, or by the thermal camera if there are none; a person in no image is neither a miss nor a false
    alarm.

    Args:
        folder: folder of the run.
        people: truth.parquet, with the columns `PEOPLE` and others.
        beliefs: tracks.parquet.
        robot: robot.parquet.
    """
    standing, believed = places_of_people(people, robot), places_of_tracks(beliefs)
    visible, counted = _viewed(folder, people)
    confidence = _placed(beliefs)["confidence"].to_numpy()
    return standing.as_targets(counted, visible), believed.as_candidates(confidence)


def _viewed(folder: Path, people: pa.Table) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the visible fraction (N,) of people in the best image, and whether any image counts them."""
    boxed = [folder / "truth" / f"{path.stem}.parquet" for path in sorted((folder / "tracks").glob("*.txt"))]
    views = [read_table(path, TRUTH, VIEW) for path in boxed] or [people]
    most: dict[tuple[int, int], float] = defaultdict(float)
    counted: set[tuple[int, int]] = set()
    for view in views:
        for frame, number, visible, counts in zip(*(view[name].to_pylist() for name in VIEW), strict=True):
            most[frame, number] = max(most[frame, number], visible)
            counted |= {(frame, number)} if counts else set()
    rows = list(zip(people["frame"].to_pylist(), people["id"].to_pylist(), strict=True))
    return np.array([most[row] for row in rows], np.float64), np.array([row in counted for row in rows], bool)


def _placed(beliefs: pa.Table) -> pa.Table:
    is_sure = np.array([status != Status.TENTATIVE for status in beliefs["status"].to_pylist()], np.bool_)
    has_place = beliefs["place_x_m"].is_valid().to_numpy()
    return beliefs.filter(pa.array(is_sure & has_place))


def _columns(table: pa.Table, names: Sequence[str]) -> Floats:
    """Return columns as one array (N, K)."""
    return np.stack([table[name].to_numpy().astype(np.float64) for name in names], axis=-1)
