"""Convert one tick to marks on images, in the world and on plots, as plain arrays.

Pixels are those of the camera's image: the centre of the top-left pixel is (0, 0).
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.small_matrices import principal_axes
from peopleboy.scenarios.drawing.overlay import map_box
from peopleboy.scenarios.drawing.palette import ROBOT, TRUTH, Rgb, person_colour, track_colour
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.tracker.boxes import image_shares
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.reproductions.contour.particles import Particles
from peopleboy.tracker.track import Box, Status, Track, TrackPosture

PARTICLES_A_FILTER = 50
PARTICLES_AT_MOST = 100
FLAT_M = 0.01  # height at which marks on the floor are drawn
CHI_95 = 2.4477  # square root of the 95 % quantile of chi-squared with two degrees of freedom

Floats = NDArray[np.float32]
Colours = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """K boxes with a colour and a label each.

    Attributes:
        box: (K, 4) [px] left, top, width, height.
        colour: (K, 3).
        label: K texts.
    """

    box: Floats
    colour: Colours
    label: list[str]


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """K lines of n points with a colour each.

    Attributes:
        line: (K, n, 2) [px] or (K, n, 3) [m].
        colour: (K, 3).
    """

    line: Floats
    colour: Colours


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """K points with a colour each.

    Attributes:
        place: (K, 2) [px].
        colour: (K, 3).
    """

    place: Floats
    colour: Colours


@dataclass(frozen=True, slots=True, eq=False)
class Ellipses:
    """K flat ellipses on the floor with a colour and a label each, in the robot's frame.

    Attributes:
        centre: (K, 3) [m].
        half_size: (K, 3) [m] along their own axes.
        quaternion: (K, 4) x, y, z, w.
        colour: (K, 3).
        label: K texts.
    """

    centre: Floats
    half_size: Floats
    quaternion: Floats
    colour: Colours
    label: list[str]


def places(tracks: Iterable[Track], sightings: Mapping[int, Sequence[str]]) -> Ellipses:
    """Return the 95 % covariance ellipses of tracks on the floor.

    Their labels name the cameras that see them, from `Sightings`.
    """
    placed = [(track, track.place) for track in tracks if track.place is not None]
    centre = [(*place.position_m, FLAT_M) for _, place in placed]
    shapes = [_ellipse(*place.covariance_m2) for _, place in placed]
    return Ellipses(
        np.reshape(np.array(centre, np.float32), (-1, 3)),
        np.reshape(np.array([half for half, _ in shapes], np.float32), (-1, 3)),
        np.reshape(np.array([turn for _, turn in shapes], np.float32), (-1, 4)),
        colours_of(track_colour(track.id) for track, _ in placed),
        [" · ".join(filter(None, (track_label(t), "+".join(sightings.get(t.id, ()))))) for t, _ in placed],
    )


def _ellipse(xx: float, xy: float, yy: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return semi-axes [m] and quaternion of a covariance's 95 % ellipse."""
    variances, angle = principal_axes(xx, xy, yy)
    along, across = CHI_95 * np.sqrt(np.maximum(variances, FLAT_M**2))
    half_turn = angle / 2.0
    return (float(along), float(across), FLAT_M), (0.0, 0.0, math.sin(half_turn), math.cos(half_turn))


def track_boxes(tracks: Sequence[Track], camera: str = THERMAL, affine: Matrix | None = None) -> Boxes:
    """Return the boxes of tracks in a camera's image, mapped to another one by a (2, 3) affine if given."""
    placed = [track for track in tracks if camera in track.boxes]
    own = [track.boxes[camera] for track in placed]
    boxes = own if affine is None else [map_box(box, affine) for box in own]
    return Boxes(
        _boxes(boxes), colours_of(track_colour(t.id) for t in placed), [track_label(t) for t in placed]
    )


_STANDINGS = {Status.TENTATIVE: "doubtful", Status.PARTLY_OCCLUDED: "", Status.TOTALLY_OCCLUDED: "hidden"}


def track_label(track: Track) -> str:
    """Return the label of a track: its id, and what is unusual, as "3 hidden behind 1" or "2 lying"."""
    standing = _STANDINGS.get(track.status, "")
    behind = "" if track.occluder is None else f"behind {track.occluder}"
    posture = "" if track.posture in (None, TrackPosture.UPRIGHT) else str(track.posture)
    return " ".join(word for word in (str(track.id), posture, standing, behind) if word)


def truth_boxes(people: Iterable[PersonTruth]) -> Boxes:
    """Return the true boxes of people in one camera's image, with name and visible share.

    People behind the camera are omitted.
    """
    seen = [(person, person.box) for person in people if person.box is not None]
    labels = [f"{person.name} {person.visible_fraction:.0%}" for person, _ in seen]
    return Boxes(_boxes([box for _, box in seen]), colours_of(TRUTH for _ in seen), labels)


def particle_points(particles: Mapping[int, Particles]) -> Points:
    """Choose particles of each filter to show: one half by weight, the other evenly from the rest.

    They have the colour of their track, white for the detector's (id 0); the lower the weight, the darker.
    """
    if not particles:
        return Points(np.zeros((0, 2), np.float32), np.zeros((0, 3), np.uint8))
    count = min(PARTICLES_A_FILTER, PARTICLES_AT_MOST // len(particles))
    clouds = [_sample(cloud, number, count) for number, cloud in particles.items()]
    return Points(np.concatenate([c.place for c in clouds]), np.concatenate([c.colour for c in clouds]))


def _sample(cloud: Particles, number: int, count: int) -> Points:
    order = np.argsort(-cloud.weight, kind="stable")
    strongest = min(count // 2, len(order))
    others = np.linspace(strongest, len(order) - 1, min(count, len(order)) - strongest)
    rows = np.concatenate([order[:strongest], order[others.astype(np.int64)]])
    strength = 0.25 + 0.75 * cloud.weight[rows] / max(float(cloud.weight.max()), 1e-12)
    colour = np.array(track_colour(number) if number > 0 else (255, 255, 255))
    return Points(cloud.state[rows, :2], np.rint(strength[:, None] * colour).astype(np.uint8))


class Sightings:
    """Keeps which tracks have a box in the newest image of each camera."""

    def __init__(self, cameras: Sequence[str]) -> None:
        self._cameras = cameras
        self._seen: dict[int, set[str]] = {}

    def update(self, tick: Tick) -> Mapping[int, Sequence[str]]:
        """Return the cameras by track; a camera without an image at this tick counts by its last image."""
        older = {*self._cameras} - {*tick.observation.images}
        self._seen = {t.id: {*t.boxes} | (older & self._seen.get(t.id, set())) for t in tick.tracks}
        return {number: [c for c in self._cameras if c in seen] for number, seen in self._seen.items()}


class Trails:
    """Converts positions, frame by frame, to segments of trails."""

    def __init__(self) -> None:
        self._last: dict[int, tuple[float, float]] = {}

    def update(self, tick: Tick) -> Lines:
        """Return the segments (2, 3) [m] since the last tick: of the robot, and of people present at both."""
        robot = tick.truth.robot
        places = {0: (robot.x, robot.y)} | {p.id: p.position_m for p in tick.truth.people}
        moved = [number for number in places if number in self._last]
        lines = [np.array([[*self._last[n], 0.02], [*places[n], 0.02]]) for n in moved]
        self._last = places
        return Lines(lines_of(lines, 3), colours_of(person_colour(n) if n > 0 else ROBOT for n in moved))


def visible_fractions(tick: Tick, names: Iterable[str]) -> list[float]:
    """Return each person's visible fraction in the order of names; 0 for people who are absent."""
    visible = {person.name: person.visible_fraction for person in tick.truth.people}
    return [visible.get(name, 0.0) for name in names]


def box_offset(box: Box, width_px: int) -> float:
    """Return how far the middle of a box is right of the thermal image's centre [half image widths]."""
    return image_shares(box, width_px, 1).x


def _boxes(boxes: Sequence[tuple[float, float, float, float]]) -> Floats:
    return np.reshape(np.array(boxes, np.float32), (-1, 4))


def lines_of(lines: Sequence[NDArray[np.float64]], size: int) -> Floats:
    """Stack K lines of n points with 2 or 3 coordinates; without any, return (0, 2, dimension)."""
    return np.array(lines, np.float32) if lines else np.zeros((0, 2, size), np.float32)


def colours_of(colours: Iterable[Rgb]) -> Colours:
    """Stack colours (K, 3)."""
    return np.reshape(np.array(list(colours), np.uint8), (-1, 3))


LEAST_SHARE = 0.02  # occluded share of a silhouette from which an arrow is drawn
_CHEST, _HEAD = 0.3, 0.08  # where arrows on images start and end, in box heights below the top
_HEIGHT_M = 1.3  # where arrows in the world are


@dataclass(frozen=True, slots=True, eq=False)
class Arrows:
    """K arrows with a colour and a label each.

    Attributes:
        start: (K, 2) [px] or (K, 3) [m].
        vector: (K, 2) or (K, 3) from there to the tip.
        colour: (K, 3).
        label: K texts.
    """

    start: Floats
    vector: Floats
    colour: Colours
    label: list[str]


def true_arrows(people: Sequence[PersonTruth]) -> Arrows:
    """Return arrows on the thermal image from occluder to occluded person, with the occluded share."""
    pairs = [
        (_point(front.box, _CHEST), _point(behind.box, _HEAD), TRUTH, f"{share:.0%}")
        for front, behind, share in _hiding(people)
        if front.box is not None and behind.box is not None
    ]
    return _arrows(pairs, 2)


def world_arrows(people: Sequence[PersonTruth]) -> Arrows:
    """Return arrows in the world from occluder to occluded person."""
    pairs = [
        ((*front.position_m, _HEIGHT_M), (*behind.position_m, _HEIGHT_M), TRUTH, f"{share:.0%}")
        for front, behind, share in _hiding(people)
    ]
    return _arrows(pairs, 3)


def believed_arrows(tracks: Iterable[Track]) -> Arrows:
    """Return arrows on the thermal image from occluding to occluded track, in the occluder's colour."""
    known = {track.id: (track, track.boxes[THERMAL]) for track in tracks if THERMAL in track.boxes}
    pairs = [
        (_point(known[front][1], _CHEST), _point(box, _HEAD), track_colour(front), str(behind.status))
        for behind, box in known.values()
        if (front := behind.occluder) is not None and front in known
    ]
    return _arrows(pairs, 2)


def _hiding(people: Sequence[PersonTruth]) -> Iterator[tuple[PersonTruth, PersonTruth, float]]:
    """Yield the occluder, the occluded person, and the occluded share."""
    known = {person.name: person for person in people}
    for behind in people:
        for name, share in behind.hidden_by.items():
            if name in known and share >= LEAST_SHARE:
                yield known[name], behind, share


def _point(box: Box, down: float) -> tuple[float, float]:
    left, top, width, height = box
    return left + width / 2.0, top + down * height


_Pair = tuple[tuple[float, ...], tuple[float, ...], Rgb, str]


def _arrows(pairs: Sequence[_Pair], size: int) -> Arrows:
    start = np.array([pair[0] for pair in pairs], np.float32).reshape(-1, size)
    tip = np.array([pair[1] for pair in pairs], np.float32).reshape(-1, size)
    return Arrows(start, tip - start, colours_of(pair[2] for pair in pairs), [pair[3] for pair in pairs])
