"""The peer: OpenCV's HOG on the thermal picture, with ByteTrack, by the values that suit these clips best."""

from __future__ import annotations

from typing import Final

from trackers import ByteTrackTracker

from benchmarks.clips.clip import WIDTH_PER_HEIGHT
from benchmarks.peers.contestants import DetectAndAssociate
from benchmarks.peers.detectors import Hog

# Chosen in the peer's favour, by the mean HOTA of camel_08 and camel_21 among XXX.
_STRONG: Final = 0.5


def make_peer() -> DetectAndAssociate:
    """Make it for one clip."""
    tracker = ByteTrackTracker(track_activation_threshold=_STRONG, high_conf_det_threshold=_STRONG)
    return DetectAndAssociate(Hog(uses_colour=False, width_per_height=WIDTH_PER_HEIGHT), tracker)
