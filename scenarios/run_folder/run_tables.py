"""Define the parquet tables of a run: truth, tracks and robot, a row per frame and person, track or robot."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from peopleboy.scenarios.loop.loop import Tick
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.tracker.contour.explanation import ContourExplanation, Ellipse
from peopleboy.tracker.contour.variants import VARIANTS
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.fusion.fused_explanations import parts_of
from peopleboy.tracker.track import FloorPlace, Status, Track

STATE = ("x", "y", "w", "h", "d", "vx", "vy", "vw", "vh")
SPREAD = "uncertainty_px2"
COLUMNS = (SPREAD, *STATE)
"""Columns of the tracks table that have no value for trackers without contours."""

_NOTHING: Mapping[str, Any] = dict.fromkeys(COLUMNS)


def explained(explanation: object, track: int) -> Mapping[str, Any]:
    """Return the values of `COLUMNS` for a track; None for a kind of explanation without contours."""
    if isinstance(explanation, ContourExplanation) and track in explanation.ellipses:
        return {SPREAD: explanation.spread_px2[track], **asdict(explanation.ellipses[track])}
    found = (explained(part, track) for part in parts_of(explanation))
    return next((values for values in found if values is not _NOTHING), _NOTHING)


def read_explanation(tracker: str, rows: Iterable[Mapping[str, Any]]) -> ContourExplanation | None:
    """Read back what a tracker of that name explained at one frame; None if its rows hold nothing of it."""
    told = [row for row in rows if row[SPREAD] is not None]
    if not told or tracker not in VARIANTS:
        return None
    return ContourExplanation(
        config=VARIANTS[tracker],
        ellipses={row["id"]: Ellipse(**{name: row[name] for name in STATE}) for row in told},
        spread_px2={row["id"]: row[SPREAD] for row in told},
    )


Row = dict[str, Any]


def _box_fields(prefix: str) -> list[pa.Field]:
    return [pa.field(f"{prefix}{edge}_px", pa.float64()) for edge in ("left", "top", "width", "height")]


def _floats(*names: str) -> list[pa.Field]:
    return [pa.field(name, pa.float64()) for name in names]


PLACE: Final = ("place_x_m", "place_y_m", "place_xx_m2", "place_xy_m2", "place_yy_m2")
_EDGES = ("left_px", "top_px", "width_px", "height_px")
_INSTANT = [pa.field("frame", pa.int64()), pa.field("time_s", pa.float64())]

TRUTH = pa.schema(
    [
        *_INSTANT,
        pa.field("id", pa.int64()),
        pa.field("name", pa.string()),
        *_floats("x_m", "y_m", "heading_rad", "velocity_x_m_s", "velocity_y_m_s", "distance_m"),
        pa.field("posture", pa.string()),
        pa.field("is_counted", pa.bool_()),
        *_box_fields(""),
        *_box_fields("whole_"),
        *_box_fields("visible_"),
        pa.field("whole_px", pa.int64()),
        pa.field("visible_px", pa.int64()),
        *_floats("visible_fraction", "occluded_fraction"),
        pa.field("occluder", pa.string()),
        pa.field("hidden_by", pa.map_(pa.string(), pa.float64())),
        pa.field("part_temperature_c", pa.map_(pa.string(), pa.float64())),
        pa.field("joints_m", pa.list_(pa.float64(), 51)),
        pa.field("joints_px", pa.list_(pa.float64(), 34)),
        pa.field("joint_is_visible", pa.list_(pa.bool_(), 17)),
    ]
)

TRACKS = pa.schema(
    [
        *_INSTANT,
        pa.field("id", pa.int64()),
        pa.field("status", pa.string()),
        *_floats("confidence", "age_s", SPREAD),
        *_box_fields(""),
        *_floats(*PLACE),
        *_floats(*STATE),
        pa.field("occluder", pa.int64()),
    ]
)

ROBOT = pa.schema(
    [
        *_INSTANT,
        *_floats("x_m", "y_m", "heading_rad", "linear_m_s", "angular_rad_s"),
        *_floats("odometry_x_m", "odometry_y_m", "odometry_heading_rad", "left_wheel_m_s", "right_wheel_m_s"),
        *_floats("command_linear_m_s", "command_angular_rad_s"),
        pa.field("command_is_emergency", pa.bool_()),
        pa.field("mode", pa.string()),
        pa.field("sonar_m", pa.list_(pa.float64(), 16)),
        pa.field("contacts", pa.list_(pa.string())),
    ]
)

MAY_BE_EMPTY = frozenset(
    (
        "occluder",
        *COLUMNS,
        *PLACE,
        *(f"{prefix}{edge}" for prefix in ("", "whole_", "visible_") for edge in _EDGES),
    )
)
"""Columns that have no value where there is nobody or nothing to tell of."""


def truth_rows(tick: Tick, camera: str = "thermal") -> list[Row]:
    """Rows of a camera's truth table for one tick: one per person present."""
    return [_person_row(tick, person) for person in tick.truths[camera].people]


def is_in_image(people: pa.Table) -> NDArray[np.bool_]:
    """(N,) whether any of the silhouette lies inside the image."""
    outside = np.array([dict(shares).get("border", 0.0) for shares in people["hidden_by"].to_pylist()])
    return np.asarray((people["whole_px"].to_numpy() > 0) & (outside.reshape(-1) < 1.0))


def track_rows(tick: Tick) -> list[Row]:
    """Rows of the tracks table for one tick: one per track, tentative ones too."""
    return [track_row(tick.frame, tick.truth.time_s, track, tick.explanation) for track in tick.tracks]


def robot_row(tick: Tick) -> Row:
    """Row of the robot table for one tick."""
    truth, senses = tick.truth, tick.observation
    left, right = senses.wheel_speeds_m_s
    return _instant(tick) | {
        "x_m": truth.robot.x,
        "y_m": truth.robot.y,
        "heading_rad": truth.robot.heading,
        "linear_m_s": truth.robot_velocity[0],
        "angular_rad_s": truth.robot_velocity[1],
        "odometry_x_m": senses.odometry.x,
        "odometry_y_m": senses.odometry.y,
        "odometry_heading_rad": senses.odometry.heading,
        "left_wheel_m_s": left,
        "right_wheel_m_s": right,
        "command_linear_m_s": tick.command.linear_m_s,
        "command_angular_rad_s": tick.command.angular_rad_s,
        "command_is_emergency": tick.command.is_emergency,
        "mode": tick.mode,
        "sonar_m": senses.sonar_m.tolist(),
        "contacts": list(truth.contacts),
    }


def write_table(path: Path, rows: list[Row], schema: pa.Schema) -> None:
    """Write rows as a parquet file; no rows give an empty table with the same columns."""
    pq.write_table(pa.Table.from_pylist(rows, schema=schema), path)


def _instant(tick: Tick) -> Row:
    return {"frame": tick.frame, "time_s": tick.truth.time_s}


def _box(prefix: str, box: tuple[float, float, float, float] | None) -> Row:
    names = [f"{prefix}{edge}_px" for edge in ("left", "top", "width", "height")]
    return dict(zip(names, box or (None,) * 4, strict=True))


def _place(place: FloorPlace | None) -> Row:
    values = (None,) * 5 if place is None else (*place.position_m, *place.covariance_m2)
    return dict(zip(PLACE, values, strict=True))


def _person_row(tick: Tick, person: PersonTruth) -> Row:
    row = {
        "id": person.id,
        "name": person.name,
        "x_m": person.position_m[0],
        "y_m": person.position_m[1],
        "heading_rad": person.heading_rad,
        "velocity_x_m_s": person.velocity_m_s[0],
        "velocity_y_m_s": person.velocity_m_s[1],
        "distance_m": person.distance_m,
        "posture": person.posture,
        "is_counted": person.is_counted,
        "whole_px": person.whole_px,
        "visible_px": person.visible_px,
        "visible_fraction": person.visible_fraction,
        "occluded_fraction": person.occluded_fraction,
        "occluder": person.occluder,
        "hidden_by": dict(person.hidden_by),
        "part_temperature_c": dict(person.part_temperature_c),
        "joints_m": person.joints_m.ravel().tolist(),
        "joints_px": person.joints_px.ravel().tolist(),
        "joint_is_visible": person.joint_is_visible.tolist(),
    }
    boxes = _box("", person.box) | _box("whole_", person.whole_box) | _box("visible_", person.visible_box)
    return _instant(tick) | row | boxes


def track_row(frame: int, time_s: float, track: Track, explanation: object, camera: str = THERMAL) -> Row:
    """Row of the tracks table for one track at one instant, with what the tracker explained of it.

    The box is that in the image of the camera of this name.
    """
    row = {
        "id": track.id,
        "status": str(track.status),
        "confidence": track.confidence,
        "age_s": track.age_s,
    }
    hider = {"occluder": track.occluder}
    return (
        {"frame": frame, "time_s": time_s}
        | row
        | _box("", track.boxes.get(camera))
        | _place(track.place)
        | hider
        | dict(explained(explanation, track.id))
    )


def track_of(row: Mapping[str, Any]) -> Track:
    """Read a track back from a row of the tracks table."""
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
    )
