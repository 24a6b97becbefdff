"""Names of trackers that use another detector: TRACKER+DETECTOR, such as detection+my_module:MyDetector."""

from pathlib import Path
from typing import Final

_PLUS: Final = "+"
_FILE: Final = ".txt"
_WEIGHTS: Final = ".npz"


def with_detector(tracker: str, detector: str | None) -> str:
    """Return the name of a tracker with a detector; None for its own detector."""
    return tracker if detector is None else f"{tracker}{_PLUS}{detector}"


def split_name(name: str) -> tuple[str, str | None]:
    """Return the names of a tracker and of its detector; None for its own detector."""
    tracker, plus, detector = name.partition(_PLUS)
    return tracker, detector if plus else None


def is_detection_file(detector: str | None) -> bool:
    """Return whether a detector is a file of detections."""
    return detector is not None and detector.lower().endswith(_FILE)


def is_network_file(detector: str | None) -> bool:
    """Return whether a detector is a network that `peopleboy train people` wrote."""
    return detector is not None and detector.lower().endswith(_WEIGHTS)


def shown_detector(detector: str) -> str:
    """Return the name of a detector as reports show it: a file without its folder."""
    is_file = is_detection_file(detector) or is_network_file(detector)
    return Path(detector).name if is_file else detector


def shown_name(name: str) -> str:
    """Return the name of a tracker as reports show it."""
    tracker, detector = split_name(name)
    return with_detector(tracker, None if detector is None else shown_detector(detector))
