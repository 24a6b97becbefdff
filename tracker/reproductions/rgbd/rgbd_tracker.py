"""The tracker of people by depth and colour on a moving robot (SA chapter 4)."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame, check_frame
from peopleboy.tracker.reproductions.rgbd.hypothesis import Detection, Hypothesis
from peopleboy.tracker.reproductions.rgbd.observation_model import (
    Body,
    colours_in,
)
from peopleboy.tracker.reproductions.rgbd.rgbd_config import RgbdConfig
from peopleboy.tracker.reproductions.rgbd.track_management import Management, associate, occluder_of
from peopleboy.tracker.sensors.depth.depth_view import DepthView, RgbdView, box_at
from peopleboy.tracker.sensors.depth.human_windows import range_of, window_of
from peopleboy.tracker.sensors.depth.pre_detection import Layout, PreDetection, PreDetector, body_position
from peopleboy.tracker.sensors.depth.window_model import WindowModel
from peopleboy.tracker.track import Box, FloorPlace, Status, Track

# Explanation of the RGB-D tracker.


@dataclass(frozen=True, slots=True, eq=False)
class RgbdExplanation:
    """State of the tracker at its newest frame.

    Attributes:
        layout: structure of the depth image.
        detections: objects of human size, classified as human or not.
        hypotheses: all hypotheses, including tentative ones.
    """

    layout: Layout
    detections: tuple[Detection, ...]
    hypotheses: tuple[Hypothesis, ...]


_LONGEST_STEP_S = 0.5
_DOUBLE_M = 0.3


class RgbdTracker:
    """Tracks people detected by size in depth and by appearance in colour.

    Args:
        config: settings.
        model: classifies windows as human.
        rng: random generator of the particles.
    """

    def __init__(
        self,
        config: RgbdConfig,
        model: WindowModel,
        rng: np.random.Generator,
    ) -> None:
        self.config = config
        self._model, self._rng = model, rng
        self._detector = PreDetector(config.size, config.above)
        self._people: tuple[Hypothesis, ...] = ()
        self._seen: RgbdView | None = None  # in the newest image
        self._time_s = -math.inf
        self._last_id = 0
        self._explanation: RgbdExplanation | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The depth camera, which also has colour."""
        return (DEPTH,)

    @property
    def explanation(self) -> RgbdExplanation | None:
        """The state at the newest frame; None before the first."""
        return self._explanation

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse an unusable depth camera before the first frame.

        Raises:
            BadInput: the camera is not calibrated, or not planar.
        """
        DepthView.of(calibrations.get(DEPTH), DEPTH)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame and return the tracks, predicted while a slower camera has no image.

        Raises:
            BadInput: the first frame has no depth image, or colour of another size, or no calibration.
        """
        check_frame(frame)
        before = None if DEPTH in frame.images else self._seen
        self._seen = view = self._view(frame) if before is None else before
        management = Management(
            self.config, view, frame.time_s, min(frame.time_s - self._time_s, _LONGEST_STEP_S), self._rng
        )
        self._time_s = frame.time_s
        if before is None:
            self._look(management, frame)
        else:
            self._people = tuple(management.expected(one, frame.odometry) for one in self._people)
        return tuple(self._track(person, frame) for person in self._people if management.is_claimed(person))

    def _look(self, management: Management, frame: Frame) -> None:
        """Process a new image."""
        view = management.view
        layout = self._detector(view.depth, view.geometry)
        detections = tuple(self._verified(found, layout, view) for found in layout.detections)
        people = self._followed(detections, management, frame)
        self._people = self._named(_without_doubles(people))
        self._explanation = RgbdExplanation(layout, detections, self._people)

    def _view(self, frame: Frame) -> RgbdView:
        geometry = DepthView.of(frame.calibrations.get(DEPTH), DEPTH)
        depth, colour = frame.depth(DEPTH), frame.rgb(DEPTH_COLOUR)
        if depth.shape != colour.shape[:2]:
            sizes = f"{depth.shape} and {colour.shape[:2]}"
            raise BadInput(f"{DEPTH} and {DEPTH_COLOUR} must show the same pixels, got {sizes}")
        return RgbdView(depth, colour, geometry, self.config.hypotheses.body_m)

    def _verified(self, found: PreDetection, layout: Layout, view: RgbdView) -> Detection:
        """Classify the window of a pre-detection (SA 4.4.2)."""
        geometry = view.geometry
        kind = range_of(found.z_m, layout.floor, geometry, len(view.depth))
        score = 0.0
        if self.config.has_verification:
            window = window_of(found.box, found.z_m, kind, layout.floor, geometry)
            score = self._model.look(view.colour, view.depth, found.z_m, window, kind)
        is_verified = not self.config.has_verification or score > self.config.least_score(kind)
        ground = layout.floor.slope * found.z_m + layout.floor.offset_m
        top = (found.box[1] - geometry.centre_v) * found.z_m / geometry.focal_px
        head = ground - top
        body = Body(
            width_m=found.width_m,
            head_m=head,
            low_m=max(head - found.height_m, 0.0),
            appearance=colours_in(view, found.box),
        )
        return Detection(
            found=found, place_m=body_position(found, view), body=body, score=score, is_verified=is_verified
        )

    def _followed(
        self, detections: Sequence[Detection], management: Management, frame: Frame
    ) -> tuple[Hypothesis, ...]:
        """Update all hypotheses, then initiate new ones."""
        looked = [
            management.looked_for(management.expected(person, frame.odometry)) for person in self._people
        ]
        people = [person for person, _ in looked]
        matched = associate(people, detections, management.time_s, self.config.hypotheses)
        followed = [
            management.found(person, update, detections[matched[k]] if k in matched else None)
            for k, (person, update) in enumerate(looked)
        ]
        kept = [person for person in followed if not management.is_over(person)]
        taken = set(matched.values())
        new = [management.born(one) for k, one in enumerate(detections) if k not in taken and one.is_verified]
        everybody = (*kept, *new)
        return tuple(replace(one, occluder=occluder_of(one, everybody, management.view)) for one in everybody)

    def _named(self, people: Sequence[Hypothesis]) -> tuple[Hypothesis, ...]:
        """Number the hypotheses with enough verifications."""
        named = []
        for person in people:
            if not person.id and person.verifications >= self.config.hypotheses.births:
                self._last_id += 1
                person = replace(person, id=self._last_id, status=Status.TRACKED)
            named.append(person)
        return tuple(named)

    def _track(self, person: Hypothesis, frame: Frame) -> Track:
        x, y = person.place_m.tolist()
        (xx, xy), (_, yy) = person.covariance_m2.tolist()
        return Track(
            id=person.id,
            boxes=_boxes(person, frame.calibrations),
            place=FloorPlace(position_m=(x, y), covariance_m2=(xx, xy, yy)),
            confidence=person.confidence,
            status=person.status,
            age_s=frame.time_s - person.born_s,
            occluder=person.occluder,
        )


def _boxes(person: Hypothesis, calibrations: Mapping[str, Calibration]) -> dict[str, Box]:
    """Return a person's box, from head to feet, in the image of each planar camera that faces the person."""
    body = person.body
    boxes = {}
    for name, calibration in calibrations.items():
        if isinstance(calibration, PinholeCalibration):
            box = box_at(DepthView.of(calibration, name), person.place_m, body.width_m, body.head_m)
            if box[2] > 0.0:
                boxes[name] = box
    return boxes


def _without_doubles(people: Sequence[Hypothesis]) -> tuple[Hypothesis, ...]:
    """Remove duplicates: of two at one position, the one verified last, or known longer, is kept."""
    kept: list[Hypothesis] = []
    for person in sorted(people, key=lambda one: (one.id == 0, -one.verified_s, one.id)):
        if all(np.hypot(*(person.place_m - other.place_m)) > _DOUBLE_M for other in kept):
            kept.append(person)
    return tuple(sorted(kept, key=lambda one: (one.id == 0, one.id)))
