"""Options of tracking in footage, including pose and field of view of an RGB-D camera, with validation."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.settings import Metavar
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.tracker.boxes import Box, corners
from peopleboy.tracker.evaluation.protocols import Protocol
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.footage.grey import Radiometry
from peopleboy.tracker.footage.live_footage import LiveSource, PixelFormat, RawFormat, parse_size
from peopleboy.tracker.frame import DEPTH, PANORAMA, THERMAL
from peopleboy.tracker.sensors.panorama.unrolling import PanoramaKind
from peopleboy.tracker.tracker_names import is_detection_file, shown_name, split_name
from peopleboy.tracker.trackers import DEFAULT_TRACKER

VERTICAL_FOV_DEG: Final = 43.0
"""Vertical field of view of the depth sensor that the tracker was designed for."""
USUAL_HEIGHT_M: Final = 1.2
"""Height of a camera above the floor where it is neither given nor found."""
STEEPEST_DEG: Final = 60.0
LEVEL_DEG: Final = 30.0
"""Maximum tilt at which boxes and floor positions are accurate; beyond, few heads are in the image."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FootageCamera:
    """A camera without distortion, whose principal point is the image centre.

    Raises:
        BadInput: focal length and field of view are both given, or a number is outside its limits.
    """

    height_m: Annotated[
        float | None,
        Field(
            alias="camera_height_m",
            description="Height of the camera above the floor.  [default: with --depth, that of the floor in "
            "the images]",
        ),
    ] = None
    pitch_deg: Annotated[
        float | None,
        Field(
            description="Pitch of the camera; positive values point down.  [default: with --depth, that of "
            "the floor in the images, otherwise 0]"
        ),
    ] = None
    focal_px: Annotated[
        float | None, Field(description="Focal length of the camera, instead of --vertical-fov-deg.")
    ] = None
    vertical_fov_deg: Annotated[
        float | None, Field(description="Vertical field of view of the camera.  [default: 43 for depth]")
    ] = None

    def __post_init__(self) -> None:
        """Validate the options."""
        if self.focal_px is not None and self.vertical_fov_deg is not None:
            raise BadInput("--focal-px and --vertical-fov-deg have the same meaning; give only one")
        _check("--camera-height-m", self.height_m, 0.0, 10.0)
        _check("--pitch-deg", self.pitch_deg, -STEEPEST_DEG, STEEPEST_DEG)
        _check("--focal-px", self.focal_px, 0.0, 1e5)
        _check("--vertical-fov-deg", self.vertical_fov_deg, 0.0, 170.0)

    @property
    def notes(self) -> list[str]:
        """Known limitations of the tracker with this camera."""
        if self.pitch_deg is None or abs(self.pitch_deg) <= LEVEL_DEG:
            return []
        return [f"boxes and positions are inaccurate beyond {LEVEL_DEG:g} degrees of pitch"]

    def geometry(self, width: int, height: int) -> Pinhole:
        """Return the camera's geometry for an image size [px]; x and y start below its lens."""
        return Pinhole(
            width=width,
            height=height,
            vertical_fov_rad=self._angle_rad(height),
            position_m=(0.0, 0.0, USUAL_HEIGHT_M if self.height_m is None else self.height_m),
            pitch_rad=math.radians(self.pitch_deg or 0.0),
        )

    def calibration(self, width: int, height: int) -> PinholeCalibration:
        """Return the calibration for an image size [px]."""
        geometry = self.geometry(width, height)
        return PinholeCalibration(geometry.intrinsics, geometry.robot_from_camera)

    def _angle_rad(self, height: int) -> float:
        if self.focal_px is not None:
            return 2.0 * math.atan(height / 2.0 / self.focal_px)
        return math.radians(VERTICAL_FOV_DEG if self.vertical_fov_deg is None else self.vertical_fov_deg)


def _check(option: str, value: float | None, low: float, high: float) -> None:
    if value is not None and not low < value < high:
        raise BadInput(f"{option} must be between {low:g} and {high:g}, got {value:g}")


DEFAULT_RATE_HZ: Final = 15.0
"""Frame rate of image folders: that of the robot's cameras, which the trackers are designed for."""
RGBD_TRACKER: Final = "rgbd"
"""Default tracker for colour and depth images."""
PANORAMA_TRACKER: Final = "panoramic"
"""Default tracker for images of a 360-degree camera."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RgbdOptions:
    """Inputs of an RGB-D camera in addition to its colour images."""

    depth: Annotated[
        Path,
        Field(description="Folder of 16-bit depth images, aligned with the colour images in FOLDER."),
    ]
    m_per_count: Annotated[
        float,
        Field(
            alias="depth_scale", description="Metres per count of the depth images; 0.001 for millimetres."
        ),
        Metavar("M"),
    ]
    camera: FootageCamera = field(default_factory=FootageCamera)


@dataclass(frozen=True, slots=True, kw_only=True)
class PanoramaOptions:
    """Kind and geometry of the images of a 360-degree camera."""

    kind: Annotated[
        PanoramaKind,
        Field(
            alias="panorama",
            description="Kind of the colour images of a 360-degree camera: equirectangular, the round image "
            "of an upright fisheye lens or of a camera below a cone-shaped mirror, or the unrolled image of "
            "the latter. Boxes are in the unrolled images.",
        ),
    ]
    elevation_deg: Annotated[
        tuple[float, float] | None,
        Field(
            description="Elevations of the lower and the upper border of panoramas [deg]; of a round image, "
            "those of its centre and its rim.  [default: square pixels around the horizon, or a fisheye "
            "lens of 180 degrees]"
        ),
        Metavar("BOTTOM TOP"),
    ] = None
    height_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RawOptions:
    """Layout of raw images on standard input."""

    size: Annotated[
        str | None,
        Field(description="Width and height of raw images on standard input, such as 640x512."),
        Metavar("WxH"),
    ] = None
    pixels: Annotated[
        PixelFormat | None, Field(description="Pixel format of raw images on standard input, as in FFmpeg.")
    ] = None

    def layout(self) -> RawFormat | None:
        """Return the layout; None if the input is not raw.

        Raises:
            BadInput: only one of the two is given, or the size is invalid.
        """
        if self.size is None and self.pixels is None:
            return None
        if self.size is None or self.pixels is None:
            raise BadInput("--size and --pixels describe raw images together; give both, or none")
        return RawFormat(parse_size(self.size), self.pixels)


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackOptions:
    """Options of tracking people in footage.

    Attributes:
        footage: folder of images, a video or a live source, thermal; with `rgbd`, a folder of colour images.
        radiometry: meaning of thermal pixel values.
        rgbd: depth images of the same view; None for other footage.
        panorama: images of a 360-degree camera; None for other footage.
        mount: pose and field of view of the thermal camera, for positions on the floor; None if unknown.
        start: initial box of a person in the first image, or "truth" for the ground truth's; None to detect
            people.
    """

    footage: Path | LiveSource
    out: Annotated[
        Path,
        Field(description="Output folder.  [default: runs/live-TIME for a live source, otherwise required]"),
    ]
    colour: Annotated[
        Path | None,
        Field(description="Folder of colour images, one per thermal image."),
    ] = None
    radiometry: Radiometry = field(default_factory=Radiometry)
    rgbd: RgbdOptions | None = None
    panorama: PanoramaOptions | None = None
    mount: FootageCamera | None = None
    calibration: Annotated[
        Path | None,
        Field(
            description="YAML file of OpenCV or ROS with the camera's intrinsics and distortion, which is "
            "corrected; boxes are in the corrected images."
        ),
    ] = None
    mask: Annotated[
        Path | None,
        Field(
            description="Picture of the size of the images; people are searched for where it is not black."
        ),
    ] = None
    rate_hz: Annotated[
        float | None,
        Field(
            ge=0.1,
            le=1000.0,
            description="Frame rate.  [default: from the video or seqinfo.ini, otherwise 15]",
        ),
    ] = None
    timestamps: Annotated[
        Path | None,
        Field(
            description="Text file with the time of each image: a time, or a time and an image, per line."
            "  [default: the times in the names of the images or in the video, else even ones]"
        ),
    ] = None
    odometry: Annotated[
        Path | None,
        Field(
            description="With --depth or --panorama: CSV file of the camera's motion, with the columns "
            "advance_m, aside_m and turn_deg and one row per image.  [default: the camera is stationary]"
        ),
    ] = None
    tracker: Annotated[str, Field(description="Tracker.")] = DEFAULT_TRACKER
    gallery: Annotated[
        Path | None,
        Field(
            description="File of the people that the tracker knows; it is read before the run if it exists, "
            "and written after it. A person from an earlier run keeps the id."
        ),
    ] = None
    truth: Annotated[
        Path | None,
        Field(
            description="Ground-truth file in VOT, OTB, MOTChallenge, KITTI or VisDrone format.  [default: "
            "the file next to the images]"
        ),
    ] = None
    protocol: Annotated[
        Protocol | None,
        Field(
            description="Which people of the ground truth are scored.  [default: those that its benchmark "
            "scores, or mot17 if unknown]"
        ),
    ] = None
    boxes: Annotated[
        BoxKind | None,
        Field(
            description="What the tracker's boxes enclose: torso or whole person.  [default: as in the "
            "ground truth, or whole if there is none]"
        ),
    ] = None
    start: Box | str | None = None
    seed: Annotated[int, Field(ge=0, description="Random seed.")] = 0
    video: Annotated[bool, Field(description="Also write overlay.mp4; needs the package av.")] = False
    overwrite: Annotated[bool, Field(description="Replace an earlier run in the output folder.")] = False

    def __post_init__(self) -> None:
        """Refuse what a live source cannot have."""
        if not isinstance(self.footage, LiveSource):
            return
        for option, value in (
            ("--colour", self.colour),
            ("--depth", self.rgbd),
            ("--panorama", self.panorama),
            ("--timestamps", self.timestamps),
            ("--truth", self.truth),
            ("--start", self.start),
        ):
            if value is not None:
                raise BadInput(f"{option}: not for the live source {self.footage.name}; leave it out")

    @property
    def name(self) -> str:
        """Name of the folder, the file or the live source."""
        return self.footage.name if isinstance(self.footage, LiveSource) else self.footage.resolve().name

    @property
    def camera(self) -> str:
        """Name of the camera in whose image boxes are."""
        if self.panorama is not None:
            return PANORAMA
        return THERMAL if self.rgbd is None else DEPTH

    @property
    def path(self) -> Path | None:
        """Path of the footage; None for a live source."""
        return None if isinstance(self.footage, LiveSource) else self.footage

    @property
    def shown_tracker(self) -> str:
        """Name of the tracker as reports show it."""
        return shown_name(self.tracker)

    @property
    def read(self) -> tuple[Path, ...]:
        """All input paths, which must not be overwritten."""
        depth = () if self.rgbd is None else (self.rgbd.depth,)
        detector = split_name(self.tracker)[1]
        detections = Path(detector) if detector is not None and is_detection_file(detector) else None
        paths = (
            self.path,
            self.colour,
            self.truth,
            self.calibration,
            self.mask,
            self.odometry,
            *depth,
            detections,
        )
        return tuple(path for path in paths if path is not None)


def parse_start(text: str) -> Box | str:
    """Parse the initial box, `X,Y,W,H` in pixels, or `truth`.

    Raises:
        BadInput: the text is neither.
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


def check_start(picture: NDArray[Any], options: TrackOptions) -> None:
    """Check the initial box against the first image (H, W) or (H, W, 3).

    Raises:
        BadInput: the box is not inside it.
    """
    if options.start is not None and not isinstance(options.start, str):
        _check_inside(options.start, picture.shape[1], picture.shape[0])


def _check_inside(box: Box, width: int, height: int) -> None:
    left, top, right, bottom = corners(box)
    if not (left >= 0 and top >= 0 and right <= width and bottom <= height):
        given = ",".join(f"{number:g}" for number in box)
        raise BadInput(f"--start {given}: X,Y,W,H must lie inside the images, which are {width}x{height}")


def colour_picture(picture: NDArray[Any], where: str) -> NDArray[np.uint8]:
    """Convert an image (H, W) or (H, W, 3) to colour, (H, W, 3).

    Raises:
        BadInput: the image is not 8-bit; `where` names the images in the message.
    """
    if picture.dtype != np.uint8:
        raise BadInput(f"{where}: images must be 8-bit, got {picture.dtype}")
    return np.repeat(picture[..., None], 3, axis=2) if picture.ndim == 2 else np.ascontiguousarray(picture)


def refuse_thermal_options(options: TrackOptions, option: str) -> None:
    """Refuse options of thermal images together with one that names other images, such as `--depth`.

    Raises:
        BadInput: one is given.
    """
    for given, path in (("--calibration", options.calibration), ("--mask", options.mask)):
        if path is not None:
            raise BadInput(f"{given}: is for thermal images; leave it out, or leave {option} out")
    if options.colour is not None or options.radiometry != Radiometry():
        raise BadInput(
            f"{option}: --colour, --temperature-range, --scale and --polarity are for thermal images only; "
            "FOLDER itself holds the colour images"
        )
