"""People by heat, depth and colour at once, and all round where a panorama is mounted."""

from __future__ import annotations

from collections.abc import Mapping

from peopleboy.tracker.frame import DEPTH, PANORAMA, Calibration, Frame
from peopleboy.tracker.fusion.ahead_tracker import AheadTracker
from peopleboy.tracker.fusion.fused_explanation import FusedExplanation
from peopleboy.tracker.handover.both_explanations import BothExplanations
from peopleboy.tracker.handover.handover_tracker import HandoverTracker
from peopleboy.tracker.panoramic.people.panoramic_tracker import PanoramicTracker
from peopleboy.tracker.rgbd.detection.depth_view import DepthView
from peopleboy.tracker.track import Track


class FusedTracker:
    """Thermal says warm, depth says where, colour says who.

    Args:
        ahead: tracks people by heat, depth and colour.
        panoramic: tracks them in the panorama, if the robot carries a camera for it.
    """

    def __init__(self, ahead: AheadTracker, panoramic: PanoramicTracker) -> None:
        self._ahead, self._panoramic = ahead, panoramic
        self._round: HandoverTracker | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """Those that it cannot do without; a panorama is looked at where it is mounted."""
        return self._ahead.cameras

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse a depth camera that is none, and a panoramic one that nobody learned from.

        Raises:
            BadInput: there is one of these.
        """
        DepthView.of(calibrations.get(DEPTH), DEPTH)
        if PANORAMA in calibrations:
            self._panoramic.check_cameras(calibrations)

    @property
    def explanation(self) -> FusedExplanation:
        """What all parts believe."""
        both = (
            BothExplanations(self._ahead.explanation, None)
            if self._round is None
            else self._round.explanation
        )
        return FusedExplanation(both, self._ahead.by_depth)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame, whichever images it has, and tell who is where.

        Raises:
            BadInput: as its parts say of images that are there.
        """
        if PANORAMA not in frame.calibrations:
            return self._ahead.update(frame)
        if self._round is None:
            self._round = HandoverTracker(self._ahead, self._panoramic)
        return self._round.update(frame)
