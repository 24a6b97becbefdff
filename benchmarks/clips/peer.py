"""The peers: OpenCV's HOG on the enlarged thermal picture, with ByteTrack, by values for clips."""

from __future__ import annotations

from typing import Final

from trackers import ByteTrackTracker

from benchmarks.peers.contestants import DetectAndAssociate
from benchmarks.peers.detectors import Boxes, Hog
from peopleboy.tracker.boxes import within_image
from peopleboy.tracker.frame import THERMAL, Frame

# Chosen in the peers' favour, by the mean HOTA of camel_08 and camel_21: of confidences .4 to .94, of 1 and
# 5 s to remember who is lost, and of two widths over height. HOG's weak windows only make false tracks.
_STRONG: Final = 0.91
_WIDE: Final = 0.43  # of .43 and the .45 of ours
_LOST_BUFFER: Final = 150  # frames at the 30 Hz that the package counts in
_WEAKEST: Final = 0.0  # distance from the classifier's boundary


class PeerOfClips(DetectAndAssociate):
    """A peer whose boxes end at the image's borders, as ours and those of annotators do."""

    def step(self, frame: Frame) -> tuple[Boxes, list[int]]:
        """Detect, associate, and cut off."""
        boxes, ids = super().step(frame)
        height_px, width_px = frame.images[THERMAL].shape[:2]
        return within_image(boxes, width_px, height_px), ids


def make_peer(enlarged: float) -> PeerOfClips:
    """Make it for one clip, whose pictures it enlarges so many times."""
    tracker = ByteTrackTracker(
        lost_track_buffer=_LOST_BUFFER, track_activation_threshold=_STRONG, high_conf_det_threshold=_STRONG
    )
    hog = Hog(uses_colour=False, width_per_height=_WIDE, enlarged=enlarged, weakest=_WEAKEST)
    return PeerOfClips(hog, tracker)
