"""What to track in footage, and how."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from peopleboy.scenarios.footage.rgbd_camera import RgbdCamera
from peopleboy.tracker.boxes import Box
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.footage.grey import Radiometry
from peopleboy.tracker.trackers import DEFAULT_TRACKER

DEFAULT_RATE_HZ: Final = 15.0
"""Pictures a second of a folder: those of the robot's cameras, for which the trackers are made."""
RGBD_TRACKER: Final = "rgbd"
"""The tracker of colour with depth, unless another one is named."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RgbdOptions:
    """What there is beside colour pictures of an RGB-D camera.

    Attributes:
        depth: folder of depth pictures, of the same pixels as the colour ones.
        m_per_count: metres that a count stands for.
        camera: where it stood, and how wide it sees.
        odometry: file of how it moved; None for a camera that stands.
    """

    depth: Path
    m_per_count: float
    camera: RgbdCamera = field(default_factory=RgbdCamera)
    odometry: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackOptions:
    """What to track, and how.

    Attributes:
        footage: folder of pictures, or a video: thermal ones, or with `rgbd` a folder of colour ones.
        out: folder to leave.
        colour: folder or video that shows the same view in colour; None for none.
        radiometry: what is known of thermal pixels.
        rgbd: depth of the same view; None for thermal footage.
        rate_hz: pictures a second; None for the footage's own, or `DEFAULT_RATE_HZ`.
        tracker: name of the tracker.
        truth: a truth file; None to look for one beside the pictures.
        boxes: what our trackers' boxes are drawn round; None for what those of the truth are, or all of a
            person.
        start: box of a person in the first picture, or "truth" for that of the truth; None to find people.
        seed: 0 or more; everything random follows from it.
        film: whether to write overlay.mp4.
        overwrite: whether an earlier run in the folder may be replaced.
    """

    footage: Path
    out: Path
    colour: Path | None = None
    radiometry: Radiometry = field(default_factory=Radiometry)
    rgbd: RgbdOptions | None = None
    rate_hz: float | None = None
    tracker: str = DEFAULT_TRACKER
    truth: Path | None = None
    boxes: BoxKind | None = None
    start: Box | str | None = None
    seed: int = 0
    film: bool = False
    overwrite: bool = False

    @property
    def read(self) -> tuple[Path, ...]:
        """All that is read, and must not be replaced."""
        depth = () if self.rgbd is None else (self.rgbd.depth, self.rgbd.odometry)
        return tuple(path for path in (self.footage, self.colour, self.truth, *depth) if path is not None)
