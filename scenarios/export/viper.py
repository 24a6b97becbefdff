"""ViPER XML, the format of the sources' evaluation tool: RUN/truth.xgtf and RUN/tracks.xgtf.

The default camera is the thermal one. Images of any camera are numbered from 1. Results are written if the
tracker has boxes in its images.

People and tracks are objects whose attributes change from frame to frame. ViPER's schema allows whole pixels
inside the image only in a `bbox`; four further decimal attributes hold the exact box. For a box across a
panorama's seam, one `bbox` holds the part at the right border, and another the part at the left.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import pyarrow as pa

from peopleboy.scenarios.drawing.overlay import box_parts
from peopleboy.scenarios.export.replay import OneCamera, Play, with_people
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.sim.geometry.panorama import around_px
from peopleboy.sim.truth.truth import Box
from peopleboy.tracker.evaluation.mot_files import read_truth
from peopleboy.tracker.evaluation.sequence import TrackBoxes

VIPER, DATA = "http://lamp.cfar.umd.edu/viper#", "http://lamp.cfar.umd.edu/viperdata#"

_EDGES = ("LEFT", "TOP", "WIDTH", "HEIGHT")
_FILE = {
    "SOURCETYPE": "lvalue",
    "NUMFRAMES": "dvalue",
    "FRAMERATE": "fvalue",
    "H-FRAME-SIZE": "dvalue",
    "V-FRAME-SIZE": "dvalue",
}
_SOURCE_TYPES = ("SEQUENCE", "FRAMES")
OBJECT = {"NAME": "svalue", "LOCATION": "bbox", **dict.fromkeys(_EDGES, "fvalue")}
ALL_ROUND = {"BEYOND_SEAM": "bbox"}
TRUTH = {"COUNTED": "bvalue", "VISIBLE": "fvalue"}
TRACK = {"CONFIDENCE": "fvalue"}


@dataclass(frozen=True, slots=True)
class _Person:
    """The attributes of one person or track, by frame."""

    name: str
    boxes: dict[int, Box] = field(default_factory=dict)
    others: dict[str, dict[int, str]] = field(default_factory=dict)

    def add(self, frame: int, box: Iterable[float], **others: str) -> None:
        left, top, width, height = map(float, box)
        self.boxes[frame] = (left, top, width, height)
        for name, value in others.items():
            self.others.setdefault(name, {})[frame] = value


def write_viper(
    runs: Sequence[FinishedRun],
    folder: Path,
    play: Play,  # noqa: ARG001
    camera: str = "thermal",
) -> None:
    """Write a file of ground truth and one of results for each run.

    Raises:
        BadInput: a run has no such camera.
    """
    ElementTree.register_namespace("", VIPER)
    ElementTree.register_namespace("data", DATA)
    for run in runs:
        shots, files = with_people(run, camera), run.files()
        (folder / run.name).mkdir()
        _write(folder / run.name / "truth.xgtf", shots, _people(shots, files.people), TRUTH)
        tracks = files.tracks if camera == "thermal" else files.further.get(camera)
        if tracks is not None:
            _write(folder / run.name / "tracks.xgtf", shots, _tracks(shots, tracks), TRACK)


def whole_pixels(box: Box, width: int, height: int) -> tuple[int, int, int, int] | None:
    """Return the pixels inside the image that a box touches: x, y, width, height; None if there are none."""
    left, top, right, bottom = box[0] + 0.5, box[1] + 0.5, box[0] + box[2] + 0.5, box[1] + box[3] + 0.5
    x, y = max(int(left // 1), 0), max(int(top // 1), 0)
    w, h = min(-int(-right // 1), width) - x, min(-int(-bottom // 1), height) - y
    return (x, y, w, h) if w > 0 and h > 0 else None


def _people(shots: OneCamera, people: pa.Table) -> dict[int, _Person]:
    truth = read_truth(shots.truth_file)
    names = dict(zip(people["id"].to_pylist(), people["name"].to_pylist(), strict=True))
    found: dict[int, _Person] = {}
    columns = (truth.frame, truth.id, truth.box, truth.counted, truth.visible)
    for frame, id_, box, counted, visible in zip(*columns, strict=True):
        person = found.setdefault(int(id_), _Person(names[int(id_)]))
        number = shots.number(int(frame))
        person.add(number, box, COUNTED=str(bool(counted)).lower(), VISIBLE=f"{visible:.4f}")
    return found


def _tracks(shots: OneCamera, tracks: TrackBoxes) -> dict[int, _Person]:
    found: dict[int, _Person] = {}
    for frame, number, box, confidence in zip(
        tracks.frame, tracks.id, tracks.box, tracks.confidence, strict=True
    ):
        track = found.setdefault(int(number), _Person(f"track {number}"))
        if frame not in shots.frames:
            continue
        track.add(shots.number(int(frame)), box, CONFIDENCE=f"{confidence:.4f}")
    return found


def _write(path: Path, shots: OneCamera, people: Mapping[int, _Person], others: Mapping[str, str]) -> None:
    root = ElementTree.Element(f"{{{VIPER}}}viper")
    config = _child(root, "config")
    _descriptor(config, "Information", "FILE", _FILE, dynamic=())
    places = {} if math.isinf(around_px(shots.camera)) else ALL_ROUND
    changing = ("LOCATION", *_EDGES, *places, *others)
    _descriptor(config, "PERSON", "OBJECT", {**OBJECT, **places, **others}, dynamic=changing)
    source = _child(_child(root, "data"), "sourcefile", filename=shots.run.name)
    _file(source, shots)
    for number, person in sorted(people.items()):
        _object(source, number, person, shots, places, others)
    ElementTree.indent(root)
    ElementTree.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def _descriptor(
    config: ElementTree.Element, name: str, kind: str, attributes: Mapping[str, str], dynamic: Sequence[str]
) -> None:
    descriptor = _child(config, "descriptor", name=name, type=kind)
    for attribute, value in attributes.items():
        is_dynamic = str(attribute in dynamic).lower()
        made = _child(descriptor, "attribute", dynamic=is_dynamic, name=attribute, type=f"{DATA}{value}")
        if value == "lvalue":
            possibles = _value(made, "lvalue-possibles")
            for word in _SOURCE_TYPES:
                _value(possibles, "lvalue-enum", value=word)


def _file(source: ElementTree.Element, shots: OneCamera) -> None:
    values = ("FRAMES", str(len(shots.frames)), str(float(shots.rate_hz)), *map(str, shots.size))
    file = _child(source, "file", id="0", name="Information")
    for (name, kind), value in zip(_FILE.items(), values, strict=True):
        _value(_child(file, "attribute", name=name), kind, value=value)


def _object(
    source: ElementTree.Element,
    number: int,
    person: _Person,
    shots: OneCamera,
    places: Iterable[str],
    others: Mapping[str, str],
) -> None:
    spans = _framespan(person.boxes)
    thing = _child(source, "object", framespan=spans, id=str(number), name="PERSON")
    _value(_child(thing, "attribute", name="NAME"), "svalue", value=person.name)
    for part, place in enumerate(("LOCATION", *places)):
        _location(_child(thing, "attribute", name=place), part, person, shots)
    for k, edge in enumerate(_EDGES):
        attribute = _child(thing, "attribute", name=edge)
        for frame, box in person.boxes.items():
            _value(attribute, "fvalue", framespan=f"{frame}:{frame}", value=f"{box[k]:.2f}")
    for name, kind in others.items():
        attribute = _child(thing, "attribute", name=name)
        for frame, value in person.others[name].items():
            _value(attribute, kind, framespan=f"{frame}:{frame}", value=value)


def _location(attribute: ElementTree.Element, part: int, person: _Person, shots: OneCamera) -> None:
    """Return the place of one part of each box in the image, if the box has such a part."""
    parts = {frame: box_parts(box, shots.camera) for frame, box in person.boxes.items()}
    for frame, box in ((frame, own[part]) for frame, own in parts.items() if part < len(own)):
        pixels = whole_pixels(box, *shots.size)
        if pixels is not None:
            edges = dict(zip(("x", "y", "width", "height"), map(str, pixels), strict=True))
            _value(attribute, "bbox", framespan=f"{frame}:{frame}", **edges)


def _framespan(frames: Iterable[int]) -> str:
    """Format frames as ViPER does: 3:7 12:40."""
    spans: list[list[int]] = []
    for frame in sorted(frames):
        if spans and frame == spans[-1][1] + 1:
            spans[-1][1] = frame
        else:
            spans.append([frame, frame])
    return " ".join(f"{first}:{last}" for first, last in spans)


def _child(parent: ElementTree.Element, tag: str, /, **attributes: str) -> ElementTree.Element:
    return ElementTree.SubElement(parent, f"{{{VIPER}}}{tag}", attributes)


def _value(parent: ElementTree.Element, kind: str, /, **attributes: str) -> ElementTree.Element:
    return ElementTree.SubElement(parent, f"{{{DATA}}}{kind}", attributes)
