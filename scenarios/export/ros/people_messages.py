"""ROS 2 messages of true and tracked people: boxes, positions, markers for RViz, and people_msgs."""

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.export.ros.message_types import (
    BASE,
    MAP,
    ODOM,
    Content,
    Message,
    header,
    nanoseconds,
    optical,
    pose_at,
    pose_with_covariance,
    vector,
)
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.sim.truth.truth import Box, PersonTruth, Truth
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Status, Track, confirmed

_PERSON_M: Final = 1.7  # height of a tracked person's marker
_OVER_EYES_M: Final = 0.12  # from the highest joint, an eye or an ear, to the top of the head
_WIDE_M: Final = 0.45
_TEXT_M: Final = 0.2
_CYLINDER, _TEXT, _ADD, _DELETE_ALL = 3, 9, 0, 3  # of visualization_msgs/Marker
_OVER_S: Final = 1.0  # over which a track's velocity is measured


class PeopleMessages:
    """Converts the people of successive ticks to messages.

    Args:
        cameras: names of the robot's cameras.
        further: names of the cameras besides the thermal one that have ground truth.
    """

    def __init__(self, cameras: Sequence[str], further: Sequence[str]) -> None:
        self._cameras, self._further = cameras, further
        self._paths: dict[int, deque[tuple[int, float, float]]] = {}

    def messages(self, tick: Tick, time_ns: int) -> Iterator[Message]:
        """Yield all messages of one tick."""
        yield _detections("/truth/people", _people(tick.truth), time_ns)
        for name in (name for name in self._further if name in tick.truths):
            yield _detections(f"/truth/{name}/people", _people(tick.truths[name]), time_ns, name)
        for name in (name for name in self._cameras if name in tick.observation.images):
            tracks = [(str(t.id), box, t.confidence) for t, box in confirmed(tick.tracks, name)]
            if name == THERMAL:
                yield _detections("/tracks", tracks, time_ns)
            elif tracks:
                yield _detections(f"/tracks/{name}", tracks, time_ns, name)
        placed = [t for t in tick.tracks if t.status is not Status.TENTATIVE and t.place is not None]
        yield _places(placed, header(BASE, time_ns))
        yield _markers("/tracks/markers", map(_track_markers, placed), header(BASE, time_ns))
        yield _markers("/truth/markers", map(_true_markers, tick.truth.people), header(MAP, time_ns))
        yield "/people", "people_msgs/People", self._tracked(placed, tick.observation.odometry, time_ns)
        people = [
            _person(p.name, p.position_m, p.velocity_m_s, 1.0, {"posture": p.posture})
            for p in tick.truth.people
        ]
        yield "/truth/positions", "people_msgs/People", {"header": header(MAP, time_ns), "people": people}

    def _tracked(self, tracks: Sequence[Track], odometry: Pose2, time_ns: int) -> Content:
        """Return tracks in the odometry frame, with their mean velocity over the last second."""
        people, paths = [], {}
        for track in tracks:
            assert track.place is not None
            place = odometry.transform_point(track.place.position_m)
            path = paths[track.id] = self._paths.get(track.id, deque())
            path.append((time_ns, *place))
            while time_ns - path[0][0] > nanoseconds(_OVER_S):
                path.popleft()
            first_ns, x, y = path[0]
            span_s = max((time_ns - first_ns) / 1e9, 1e-9)
            velocity = ((place[0] - x) / span_s, (place[1] - y) / span_s)
            people.append(
                _person(str(track.id), place, velocity, track.confidence, {"status": track.status.value})
            )
        self._paths = paths
        return {"header": header(ODOM, time_ns), "people": people}


def _person(
    name: str,
    place: tuple[float, float],
    velocity: tuple[float, float],
    reliability: float,
    tags: Mapping[str, str],
) -> Content:
    return {
        "name": name, "position": vector(*place, 0.0), "velocity": vector(*velocity, 0.0),
        "reliability": reliability, "tagnames": list(tags), "tags": list(tags.values()),
    }  # fmt: skip


Body = tuple[
    str, int, tuple[float, float], float, tuple[int, int, int]
]  # label, id, place, height [m], colour


def _track_markers(track: Track) -> Body:
    assert track.place is not None
    return str(track.id), track.id, track.place.position_m, _PERSON_M, track_colour(track.id)


def _true_markers(person: PersonTruth) -> Body:
    height = float(person.joints_m[:, 2].max()) + _OVER_EYES_M
    return person.name, person.id, person.position_m, height, track_colour(person.id)


def _markers(topic: str, bodies: Iterator[Body], head: Content) -> Message:
    """Return people as labelled cylinders, which replace all earlier ones."""
    markers = [_marker(head, 0, _ADD, (0.0, 0.0, 0.0)) | {"action": _DELETE_ALL}]
    for label, number, (x, y), height, colour in bodies:
        look = {"scale": vector(_WIDE_M, _WIDE_M, height), "color": _colour(colour, 0.6), "ns": "people"}
        markers.append(_marker(head, number, _CYLINDER, (x, y, height / 2.0)) | look)
        text = {"scale": vector(0.0, 0.0, _TEXT_M), "color": _colour((255, 255, 255), 1.0), "ns": "names"}
        markers.append(_marker(head, number, _TEXT, (x, y, height + _TEXT_M)) | text | {"text": label})
    return topic, "visualization_msgs/MarkerArray", {"markers": markers}


def _marker(head: Content, number: int, kind: int, place: tuple[float, float, float]) -> Content:
    still = {"sec": 0, "nanosec": 0}
    picture = {"header": head, "format": "", "data": np.zeros(0, np.uint8)}
    file = {"filename": "", "data": np.zeros(0, np.uint8)}
    return {
        "header": head, "ns": "", "id": number, "type": kind, "action": _ADD, "pose": pose_at(*place),
        "scale": vector(0.0, 0.0, 0.0), "color": _colour((0, 0, 0), 0.0), "lifetime": still,
        "frame_locked": False, "points": [], "colors": [], "texture_resource": "", "texture": picture,
        "uv_coordinates": [], "text": "",
        "mesh_resource": "", "mesh_file": file, "mesh_use_embedded_materials": False,
    }  # fmt: skip


def _colour(rgb: tuple[int, int, int], alpha: float) -> Content:
    red, green, blue = (value / 255.0 for value in rgb)
    return {"r": red, "g": green, "b": blue, "a": alpha}


def _detections(
    topic: str, found: Sequence[tuple[str, Box, float]], time_ns: int, camera: str = "thermal"
) -> Message:
    """Return people in a camera's image with name, box and score."""
    head = header(optical(camera), time_ns)
    nowhere = pose_with_covariance(Pose2(0.0, 0.0, 0.0))
    detections = []
    for name, (left, top, width, height), score in found:
        middle = {"x": left + width / 2.0, "y": top + height / 2.0}
        box = {"center": {"position": middle, "theta": 0.0}, "size_x": width, "size_y": height}
        detections.append(_detection(head, name, score, nowhere, box))
    return topic, "vision_msgs/Detection2DArray", {"header": head, "detections": detections}


def _places(tracks: Sequence[Track], head: Content) -> Message:
    """Return the positions of tracks on the floor, with covariance."""
    detections = []
    for track in tracks:
        assert track.place is not None
        xx, xy, yy = track.place.covariance_m2
        covariance = np.array([[xx, xy, 0.0], [xy, yy, 0.0], [0.0, 0.0, 0.0]])
        pose = pose_with_covariance(Pose2(*track.place.position_m, 0.0), covariance)
        box = {"center": pose["pose"], "size": vector(0.0, 0.0, 0.0)}
        detections.append(_detection(head, str(track.id), track.confidence, pose, box))
    return "/tracks/places", "vision_msgs/Detection3DArray", {"header": head, "detections": detections}


def _detection(head: Content, name: str, score: float, pose: Content, box: Content) -> Content:
    hypothesis = {"hypothesis": {"class_id": "person", "score": score}, "pose": pose}
    return {"header": head, "results": [hypothesis], "bbox": box, "id": name}


def _people(truth: Truth) -> list[tuple[str, Box, float]]:
    """Return name, box and visible fraction of all people in the image."""
    return [(p.name, p.box, p.visible_fraction) for p in truth.people if p.box is not None and p.is_in_image]
