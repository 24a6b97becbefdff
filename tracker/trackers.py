"""The trackers by name, and what anything must do to be one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Final, Protocol, runtime_checkable

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.own_code import load_own
from peopleboy.tracker.attention.attend import PersonModel
from peopleboy.tracker.attention.attention_config import PRINTED as PRINTED_ATTENTION
from peopleboy.tracker.attention.people.attentive_config import AS_FOUND
from peopleboy.tracker.attention.people.attentive_tracker import AttentiveTracker
from peopleboy.tracker.attention.people.recogniser import ByColour, ByFocus, ColourLook, Spotted
from peopleboy.tracker.contour.contour_tracker import ContourTracker
from peopleboy.tracker.contour.variants import VARIANTS
from peopleboy.tracker.frame import Calibration, Frame
from peopleboy.tracker.fusion.fused_tracker import FusedTracker, ThermalDepthTracker
from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.fusion.handover_tracker import HandoverTracker
from peopleboy.tracker.fusion.visibility import is_warm
from peopleboy.tracker.panoramic.paper.appearance_file import shipped_models
from peopleboy.tracker.panoramic.paper.paper_tracker import PanoramicPaperTracker
from peopleboy.tracker.panoramic.people.panoramic_tracker import PanoramicTracker
from peopleboy.tracker.panoramic.people.place_file import load_places
from peopleboy.tracker.rgbd.rgbd_config import PRINTED, RgbdConfig
from peopleboy.tracker.rgbd.rgbd_tracker import RgbdTracker
from peopleboy.tracker.rgbd.verification.window_model import shipped_windows
from peopleboy.tracker.track import Box, Track
from peopleboy.tracker.tracking.detection_tracker import DetectionTracker


@runtime_checkable
class Tracker(Protocol):
    """Whatever turns frames into tracks."""

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras whose images it wants; those that a robot lacks are mounted with defaults."""
        ...

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is seen."""
        ...


@runtime_checkable
class Introducible(Protocol):
    """A tracker that can be told where a person is."""

    def introduce(self, box: Box) -> None:
        """Tell that a person is at this box [px] of the thermal image in the next frame."""
        ...


@runtime_checkable
class ChecksCameras(Protocol):
    """A tracker that cannot see by every camera of the right name."""

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse cameras, by name, before the first frame.

        Raises:
            BadInput: one of them will not do.
        """
        ...


Factory = Callable[[np.random.Generator], Tracker]
"""Makes a tracker that draws all that is random from the generator."""


DETECTION_TRACKER: Final = "detection"
CONTOUR_TRACKER: Final = "contour"
DEFAULT_TRACKER: Final = DETECTION_TRACKER
BY_CONTRAST: Final = frozenset({DETECTION_TRACKER})
"""Those to which only the contrast of a thermal image matters, not how many degC a grey stands for."""


def explanation_of(tracker: Tracker) -> object:
    """Ask a tracker what it believes beyond its tracks, its `explanation`; None where it has none.

    A check of a protocol would work it out once more, and take longer than many a tracker.
    """
    return getattr(tracker, "explanation", None)


def knows_again(tracker: Tracker) -> bool:
    """Tell whether a tracker knows people again by itself, however long they were away: its `knows_again`.

    Then whoever has a new number is somebody else. None has it unless it says so.
    """
    return bool(getattr(tracker, "knows_again", False))


def _contour_tracker(name: str, rng: np.random.Generator) -> ContourTracker:
    return ContourTracker(VARIANTS[name], rng)


def _by_detection_tracker(rng: np.random.Generator) -> DetectionTracker:  # noqa: ARG001
    return DetectionTracker()


def _panoramic_paper_tracker(rng: np.random.Generator) -> PanoramicPaperTracker:  # noqa: ARG001
    return PanoramicPaperTracker(shipped_models())


def _panoramic_tracker(rng: np.random.Generator) -> PanoramicTracker:  # noqa: ARG001
    return PanoramicTracker(*load_places())


def _handover_tracker(rng: np.random.Generator) -> HandoverTracker:
    return HandoverTracker(_contour_tracker(CONTOUR_TRACKER, rng), _panoramic_tracker(rng))


def _rgbd_tracker(config: RgbdConfig, rng: np.random.Generator) -> RgbdTracker:
    return RgbdTracker(config, shipped_windows(sees_depth=config.sees_depth), rng)


def _fused_tracker(rng: np.random.Generator) -> FusedTracker:
    by_heat, by_depth = rng.spawn(2)
    thermal = _contour_tracker(CONTOUR_TRACKER, by_heat)
    rgbd = RgbdTracker(RgbdConfig(), shipped_windows(sees_depth=True), by_depth, is_warm)
    return FusedTracker(ThermalDepthTracker(thermal, rgbd, FusionConfig()), _panoramic_tracker(rng))


def _attentive_tracker(rng: np.random.Generator) -> AttentiveTracker[ColourLook, ColourLook]:
    return AttentiveTracker(_contour_tracker(CONTOUR_TRACKER, rng), ByColour())


def _attentive_printed_tracker(rng: np.random.Generator) -> AttentiveTracker[PersonModel, Spotted]:
    return AttentiveTracker(_contour_tracker(CONTOUR_TRACKER, rng), ByFocus(PRINTED_ATTENTION), AS_FOUND)


def _attentive_fused_tracker(rng: np.random.Generator) -> AttentiveTracker[ColourLook, ColourLook]:
    return AttentiveTracker(_fused_tracker(rng), ByColour())


TRACKERS: Final[dict[str, Factory]] = {
    DETECTION_TRACKER: _by_detection_tracker,
    **{name: partial(_contour_tracker, name) for name in VARIANTS},
    "panoramic-paper": _panoramic_paper_tracker,
    "panoramic": _panoramic_tracker,
    "handover": _handover_tracker,
    "rgbd": partial(_rgbd_tracker, RgbdConfig()),
    "rgbd-printed": partial(_rgbd_tracker, PRINTED),
    "fused": _fused_tracker,
    "attentive": _attentive_tracker,
    "attentive-printed": _attentive_printed_tracker,
    "attentive-fused": _attentive_fused_tracker,
}
"""Each tracker's factory by name; the first is the default. Whoever has a further one adds it here."""


def is_own(name: str) -> bool:
    """Tell whether a tracker of that name is one of your own, "module:Class"."""
    return ":" in name


def make_tracker(name: str, rng: np.random.Generator) -> Tracker:
    """Make the tracker of that name: one of `TRACKERS`, or "module:Class" for one of your own.

    Modules are looked for where Python looks for them, and in the working directory.

    Raises:
        BadInput: there is none of that name, or what is there is no tracker.
    """
    if is_own(name):
        return _own_tracker(name, rng)
    if name not in TRACKERS:
        known = ", ".join(TRACKERS)
        raise BadInput(f"unknown tracker {name!r}; there are: {known}, and your own as module:Class")
    return TRACKERS[name](rng)


def _own_tracker(name: str, rng: np.random.Generator) -> Tracker:
    tracker = load_own("tracker", name, "with a numpy.random.Generator")(rng)
    if not isinstance(tracker, Tracker):
        raise BadInput(f"tracker {name!r}: is no tracker; give it `cameras` and `update(frame)`")
    cameras = tracker.cameras
    if not isinstance(cameras, tuple) or not all(isinstance(camera, str) for camera in cameras):
        raise BadInput(
            f"tracker {name!r}: `cameras` must be a tuple of names, such as ('thermal',), got {cameras!r}"
        )
    return tracker
