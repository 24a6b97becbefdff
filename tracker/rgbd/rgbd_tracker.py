"""People tracked by depth and colour on a moving robot (SA chapter 4)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Floats, Frame, check_frame
from peopleboy.tracker.rgbd.depth_view import DepthView
from peopleboy.tracker.rgbd.human_windows import range_of, window_of
from peopleboy.tracker.rgbd.hypothesis import Detection, Hypothesis
from peopleboy.tracker.rgbd.observation_model import Body, RgbdView, box_at, colours_in
from peopleboy.tracker.rgbd.pre_detection import Layout, PreDetection, PreDetector
from peopleboy.tracker.rgbd.rgbd_config import RgbdConfig
from peopleboy.tracker.rgbd.track_management import Management, associate, occluder_of
from peopleboy.tracker.rgbd.window_model import WindowModel
from peopleboy.tracker.track import Box, FloorPlace, Status, Track

# What the RGB-D tracker believes beyond its tracks.


@dataclass(frozen=True, slots=True, eq=False)
class RgbdExplanation:
    """The newest frame as the tracker sees it.

    Attributes:
        layout: the depth image sorted out.
        detections: what has the size of a human, and whether it looks like one.
        hypotheses: all of them, those that nobody is believed to be at, too.
    """

    layout: Layout
    detections: tuple[Detection, ...]
    hypotheses: tuple[Hypothesis, ...]


_LONGEST_STEP_S = 0.5
_DOUBLE_M = 0.3


class RgbdTracker:
    """Tracks people by what has the size of a human in depth and looks like one in colour.

    Args:
        config: settings.
        model: classifies humans by their windows.
        rng: draws particles.
        is_human: classifies humans by something else than their windows; None for nothing else.
    """

    def __init__(
        self,
        config: RgbdConfig,
        model: WindowModel,
        rng: np.random.Generator,
        is_human: Callable[[PreDetection, Frame], bool] | None = None,
    ) -> None:
        self.config = config
        self._is_human = is_human
        self._model, self._rng = model, rng
        self._detector = PreDetector(config.size, config.above)
        self._people: tuple[Hypothesis, ...] = ()
        self._seen: RgbdView | None = None  # in the newest image
        self._time_s = -math.inf
        self._last_id = 0
        self._explanation: RgbdExplanation | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The depth camera, which gives colour, too."""
        return (DEPTH,)

    @property
    def explanation(self) -> RgbdExplanation | None:
        """What it made of the newest frame; None before the first."""
        return self._explanation

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse a depth camera that is none before there are images.

        Raises:
            BadInput: it has no calibration, or its image is not flat.
        """
        DepthView.of(calibrations.get(DEPTH), DEPTH)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is where; people walk on while a slower camera takes no image.

        Raises:
            BadInput: no depth image in the first frame, one without colour of its size, or no calibration.
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
        """Take in a new image."""
        view = management.view
        layout = self._detector(view.depth, view.geometry)
        detections = tuple(self._verified(found, layout, view, frame) for found in layout.detections)
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

    def _verified(self, found: PreDetection, layout: Layout, view: RgbdView, frame: Frame) -> Detection:
        """Look at the window of what was found (SA 4.4.2)."""
        geometry = view.geometry
        kind = range_of(found.z_m, layout.floor, geometry, len(view.depth))
        score = 0.0
        if self.config.has_verification:
            window = window_of(found, kind, layout.floor, geometry)
            score = self._model.look(view.colour, view.depth, found.z_m, window, kind)
        is_verified = not self.config.has_verification or score > self.config.least_score(kind)
        if not is_verified and self._is_human is not None and score > self.config.least_other_score:
            is_verified = self._is_human(found, frame)
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
            found=found, place_m=_place(found, view), body=body, score=score, is_verified=is_verified
        )

    def _followed(
        self, detections: Sequence[Detection], management: Management, frame: Frame
    ) -> tuple[Hypothesis, ...]:
        """Look for everybody who is known, then for newcomers."""
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
        """Return numbers to those who were verified often enough."""
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


def _place(found: PreDetection, view: RgbdView) -> Floats:
    """Return the place (2,) of a body's middle, which is behind the surface that is seen."""
    deeper = 1.0 + view.body_m / math.hypot(found.x_m, found.z_m)
    at = np.array([found.x_m * deeper]), np.array([found.z_m * deeper])
    return np.asarray(view.geometry.on_floor(*at)[0])


def _boxes(person: Hypothesis, calibrations: Mapping[str, Calibration]) -> dict[str, Box]:
    """Return the box of a person, from head to feet, in the image of each flat camera before which it is."""
    body = replace(person.body, low_m=0.0)
    boxes = {}
    for name, calibration in calibrations.items():
        if isinstance(calibration, PinholeCalibration):
            box = box_at(DepthView.of(calibration, name), person.place_m, body)
            if box[2] > 0.0:
                boxes[name] = box
    return boxes


def _without_doubles(people: Sequence[Hypothesis]) -> tuple[Hypothesis, ...]:
    """Of two at one place keep who was verified last, or is known for longer."""
    kept: list[Hypothesis] = []
    for person in sorted(people, key=lambda one: (one.id == 0, -one.verified_s, one.id)):
        if all(np.hypot(*(person.place_m - other.place_m)) > _DOUBLE_M for other in kept):
            kept.append(person)
    return tuple(sorted(kept, key=lambda one: (one.id == 0, one.id)))
