"""Options of tracking in footage, and their checks."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.footage.rgbd_camera import RgbdCamera
from peopleboy.settings import Metavar
from peopleboy.tracker.boxes import Box, corners
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.footage.grey import LEAST_SIDE_PX, Radiometry
from peopleboy.tracker.trackers import DEFAULT_TRACKER

DEFAULT_RATE_HZ: Final = 15.0
"""Pictures a second of a folder: those of the robot's cameras, for which the trackers are made."""
RGBD_TRACKER: Final = "rgbd"
"""The tracker of colour with depth, unless another one is named."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RgbdOptions:
    """What there is beside colour pictures of an RGB-D camera."""

    depth: Annotated[
        Path,
        Field(
            description="Folder of 16-bit depth pictures; FOLDER then holds the colours of the same pixels."
        ),
    ]
    m_per_count: Annotated[
        float,
        Field(alias="depth_scale", description="Metres a count stands for; 0.001: millimetres."),
        Metavar("M"),
    ]
    camera: RgbdCamera = field(default_factory=RgbdCamera)
    odometry: Annotated[
        Path | None,
        Field(
            description="CSV file of how it moved: advance_m, aside_m, turn_deg for each picture.  "
            "[default: it stands]"
        ),
    ] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackOptions:
    """What to track, and how.

    Attributes:
        footage: folder of pictures, or a video: thermal ones, or with `rgbd` a folder of colour ones.
        radiometry: what is known of thermal pixels.
        rgbd: depth of the same view; None for thermal footage.
        start: box of a person in the first picture, or "truth" for that of the truth; None to find people.
    """

    footage: Path
    out: Annotated[Path, Field(description="Folder to leave.")]
    colour: Annotated[Path | None, Field(description="The same view in colour, as many pictures.")] = None
    radiometry: Radiometry = field(default_factory=Radiometry)
    rgbd: RgbdOptions | None = None
    rate_hz: Annotated[
        float | None,
        Field(
            ge=0.1,
            le=1000.0,
            description="Pictures a second.  [default: the video's own, or seqinfo.ini's; 15 otherwise]",
        ),
    ] = None
    tracker: Annotated[str, Field(description="Name of the tracker.")] = DEFAULT_TRACKER
    truth: Annotated[
        Path | None,
        Field(description="VOT, OTB or MOTChallenge truth.  [default: what lies beside the pictures]"),
    ] = None
    boxes: Annotated[
        BoxKind | None,
        Field(
            description="What our trackers' boxes enclose: the torso, or the whole person.  [default: as the "
            "truth's; whole without truth]"
        ),
    ] = None
    start: Box | str | None = None
    seed: Annotated[int, Field(ge=0, description="Seed of everything random.")] = 0
    film: Annotated[bool, Field(description="Write overlay.mp4 too; needs the package av.")] = False
    overwrite: Annotated[bool, Field(description="Replace an earlier run in the folder.")] = False

    @property
    def read(self) -> tuple[Path, ...]:
        """All that is read, and must not be replaced."""
        depth = () if self.rgbd is None else (self.rgbd.depth, self.rgbd.odometry)
        return tuple(path for path in (self.footage, self.colour, self.truth, *depth) if path is not None)


def parse_start(text: str) -> Box | str:
    """Read the box to start from, `X,Y,W,H` in pixels, or `truth`.

    Raises:
        BadInput: it is neither.
    """
    if text == "truth":
        return text
    try:
        x, y, width, height = (float(part) for part in text.split(","))
    except ValueError:
        raise BadInput(f"--start must be X,Y,W,H in pixels or 'truth', got {text!r}") from None
    if not (width > 0 and height > 0):
        raise BadInput(f"--start must have a width and height above 0, got {text!r}")
    return x, y, width, height


def check_first(picture: NDArray[Any], options: TrackOptions) -> None:
    """Refuse footage by its first picture (H, W) or (H, W, 3).

    Raises:
        BadInput: it is too small, or the box to start from is not inside.
    """
    height, width = picture.shape[:2]
    if min(height, width) < LEAST_SIDE_PX:
        least = f"{LEAST_SIDE_PX}x{LEAST_SIDE_PX}"
        raise BadInput(f"{options.footage}: pictures must be at least {least}, got {width}x{height}")
    if options.start is not None and not isinstance(options.start, str):
        _check_inside(options.start, width, height)


def _check_inside(box: Box, width: int, height: int) -> None:
    left, top, right, bottom = corners(box)
    if not (left >= 0 and top >= 0 and right <= width and bottom <= height):
        given = ",".join(f"{number:g}" for number in box)
        raise BadInput(f"--start {given}: X,Y,W,H must lie inside the pictures, which are {width}x{height}")


def colour_picture(picture: NDArray[Any], where: str) -> NDArray[np.uint8]:
    """Return a picture (H, W) or (H, W, 3) in colours, (H, W, 3).

    Raises:
        BadInput: it is not of 8 bits; `where` says which pictures those are.
    """
    if picture.dtype != np.uint8:
        raise BadInput(f"{where}: pictures must be 8-bit, got {picture.dtype}")
    return np.repeat(picture[..., None], 3, axis=2) if picture.ndim == 2 else np.ascontiguousarray(picture)
