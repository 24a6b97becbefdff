"""Picture of rendered scenes in which the default tracker fails as it does in real thermal images."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import cv2
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from docs.generate.pictures.paper import panels, show
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import Track, confirmed
from peopleboy.tracker.trackers import make_tracker

_GREYS: Final = 20  # quantisation step, for small files
_LEAST: Final = 0.2  # visible fraction of the people that are drawn
_STREET: Final[Mapping[str, Any]] = {
    "kind": "street",
    "length_m": 26.0,
    "width_m": 13.0,
    "houses": "north",
    "colours": {"floor": [0.30, 0.29, 0.28], "walls": [0.42, 0.33, 0.27]},
}
_COOL: Final = {"air_c": 15.0, "floor_c": 17.0, "walls_c": 16.5}
_AS_WARM: Final = {"air_c": 30.0, "floor_c": 32.5, "walls_c": 32.0}


def _walks(*ways: Sequence[float], **more: Any) -> list[dict[str, Any]]:
    """Return people who walk between two points, given as x, y, x, y [m]."""
    return [
        {"name": f"p{k}", "path": [{"at_m": list(way[:2])}, {"at_m": list(way[2:])}]} | more
        for k, way in enumerate(ways)
    ]


_QUEUE: Final = [
    {"name": f"q{k}", "path": [{"at_m": [9.0 + 0.35 * (k % 2), 1.6 - 0.45 * k]}], "yields": False}
    for k in range(8)
]
_SCENES: Final[Mapping[str, Mapping[str, Any]]] = {
    "people as warm as their surroundings": {
        "temperatures": _AS_WARM,
        "people": _walks((9, -2.5, 9, 4), (13, 3, 13, -3), (17, -1, 8, -1), (11, 0.5, 18, 0.5)),
    },
    "a queue behind railings": {
        "temperatures": _COOL,
        "things": [
            {"kind": "railing", "at_m": [7.9, y], "facing_deg": 0.0, "size_m": [0.04, 1.9, 1.05]}
            for y in (-2.0, 0.0, 2.0)
        ],
        "people": _QUEUE,
    },
    "people seen from above": {
        "temperatures": _COOL,
        "camera": {"mount_m": [0.0, 0.0, 6.0], "pitch_deg": 50.0},
        "people": _walks((3, -2, 7, -2), (7, 0, 3.5, 0.3), (5, 2, 4, -2)),
    },
    "people who sit, lie and crouch": {
        "temperatures": _COOL,
        "things": [{"kind": "bench", "at_m": [9.0, 2.0], "facing_deg": 180.0}],
        "people": [
            {"name": "s", "path": [{"at_m": [8.8, 2.0], "posture": "sitting", "face": [0.0, 0.0]}]},
            {"name": "l", "path": [{"at_m": [7.0, -1.5], "posture": "lying"}]},
            {"name": "c", "path": [{"at_m": [8.0, 0.2], "posture": "crouching"}]},
        ],
    },
}
_FRAME: Final = 40


def failures() -> Figure:
    """Draw tracks and the people who are there, in four scenes without calibration."""
    figure, axes = panels(tuple(_SCENES), 6.4, columns=2)
    for panel, scene in zip(axes, _SCENES.values(), strict=True):
        _draw(panel, *_last(scene))
    return figure


def _last(scene: Mapping[str, Any]) -> tuple[Frame, Sequence[PersonTruth], Sequence[Track]]:
    data = {
        "name": "failure",
        "description": "A scene in which the default tracker fails.",
        "detail": "full",
        "duration_s": 4.0,
        "clothes_differ": True,
        "place": {**_STREET, "temperatures": scene["temperatures"]},
        "things": scene.get("things", []),
        "people": scene["people"],
        "robot": {
            "at_m": [0.5, 0.0],
            "cameras": {THERMAL: {"kind": THERMAL, "gain": "percentile"} | scene.get("camera", {})},
        },
    }
    scenario = parse_scenario(data, source="failure", folder=Path())
    tracker = make_tracker("detection", 0)
    with SimulatedWorld(scenario.world(0)) as world:
        for _ in range(_FRAME):
            observation = world.observe()
            frame = Frame.from_image(observation.images[THERMAL], observation.time_s)
            tracks = tracker.update(frame)
            truth = world.truth(THERMAL)
            world.step(0.0, 0.0)
    return frame, truth.people, tracks


def _draw(panel: Axes, frame: Frame, people: Sequence[PersonTruth], tracks: Sequence[Track]) -> None:
    smooth = cv2.GaussianBlur(frame.grey(THERMAL), (0, 0), 0.5)  # noise makes up most of the file size
    show(panel, smooth // _GREYS * _GREYS)
    for person in people:
        if person.box is not None and person.visible_fraction >= _LEAST:
            _box(panel, person.box, "tab:blue", "--")
    for _, box in confirmed(tracks, THERMAL):
        _box(panel, box, "tab:orange", "-")


def _box(panel: Axes, box: Sequence[float], colour: str, line: str) -> None:
    left, top, width, height = box
    panel.add_patch(Rectangle((left, top), width, height, fill=False, edgecolor=colour, ls=line, lw=1.5))
