"""Read footage of any kind as frames: thermal with optional colour, or colour with depth."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from itertools import chain, islice, zip_longest
from pathlib import Path
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import Picture, show_thermal
from peopleboy.scenarios.footage.detect_polarity import LOOK_AHEAD, detect_polarity
from peopleboy.scenarios.footage.options import (
    DEFAULT_RATE_HZ,
    FootageCamera,
    RgbdOptions,
    TrackOptions,
    check_start,
    colour_picture,
)
from peopleboy.tracker.footage.depth_pictures import DepthCounts, pair_up
from peopleboy.tracker.footage.false_colours import FalseColours
from peopleboy.tracker.footage.grey import Polarity, Radiometry
from peopleboy.tracker.footage.image_sequences import Footage, PictureFolder, folders_in, open_footage
from peopleboy.tracker.footage.lens import Lens, read_lens
from peopleboy.tracker.footage.live_footage import LiveFootage, LiveSource
from peopleboy.tracker.footage.picture_names import offsets_of, pictures_in
from peopleboy.tracker.footage.read_picture import read_picture, read_row, size_of
from peopleboy.tracker.footage.sequence_info import find_info, load_odometry, rate_in
from peopleboy.tracker.footage.thermal_images import ThermalImages, check_image, read_mask
from peopleboy.tracker.footage.time_stamps import read_time_stamps, time_stamps
from peopleboy.tracker.frame import COLOUR, DEPTH, DEPTH_COLOUR, THERMAL, Frame, Odometry
from peopleboy.tracker.sensors.depth.depth_view import DepthView
from peopleboy.tracker.sensors.depth.v_disparity import estimate_camera_pose
from peopleboy.tracker.trackers import uses_contrast

POSE_IMAGES: Final = 10
"""Number of depth images, over the whole sequence, in which the floor is searched for."""
_COLOUR_FOLDERS: Final = ("rgb", "color")
"""Where RGB-D benchmarks keep the colour images beside the depth images."""


class RgbdViews:
    """Colour and depth images of an RGB-D camera, from two folders.

    Raises:
        BadInput: a folder cannot be read, the images of both do not match, or an option is for thermal
            footage only.
    """

    camera = DEPTH
    cameras: tuple[str, ...] = (DEPTH, DEPTH_COLOUR)
    is_exact = True
    stop: Callable[[], None] | None = None

    def __init__(self, options: TrackOptions, rgbd: RgbdOptions) -> None:
        _check_kind(options)
        self._options, self._rgbd = options, rgbd
        self._counts = DepthCounts(rgbd.depth, rgbd.m_per_count)
        folders = [_folder(path, image, rgbd.depth) for path, image in _folders(options, rgbd)]
        self.notes = list(dict.fromkeys(note for folder in folders for note in folder.notes))
        self._pairs = pair_up(folders[0].paths, folders[1].paths)
        self.notes += [self._pairs.note] if self._pairs.note else []
        self.expected = len(self._pairs.colour)
        self.numbers = folders[0].numbers if self.expected == len(folders[0].paths) else None
        if options.rate_hz is not None and self._pairs.time_s is not None:
            raise BadInput("--rate-hz: the images' file names contain their times; leave it out")
        self.rate_hz = options.rate_hz or self._pairs.rate_hz or DEFAULT_RATE_HZ
        self._times_s = _given_times(options, [path.name for path in self._pairs.colour])
        self.rate_hz = _rate_of(self._times_s) or self.rate_hz
        self._offsets = offsets_of(self._pairs.colour)
        self._odometry: list[Odometry] | None = None
        if rgbd.odometry is not None:
            self._odometry = load_odometry(rgbd.odometry, self.expected)
        first = read_picture(self._pairs.colour[0], [])
        check_image(first, str(options.footage))
        self._camera = self._with_pose(rgbd.camera, (first.shape[1], first.shape[0]))
        self.notes += self._camera.notes
        self._geometry = self._camera.geometry(first.shape[1], first.shape[0])

    def _with_pose(self, camera: FootageCamera, size: tuple[int, int]) -> FootageCamera:
        """Add the height and the pitch that were not given, by the floor in the depth images."""
        if camera.height_m is not None and camera.pitch_deg is not None:
            return camera
        paths = self._pairs.depth[:: max(len(self._pairs.depth) // POSE_IMAGES, 1)][:POSE_IMAGES]
        depths = (self._counts(picture) for picture in read_row(paths, []))
        pose = estimate_camera_pose(depths, DepthView.of(camera.calibration(*size), DEPTH))
        if pose is None:
            self.notes.append(
                f"camera: no floor was found in the depth images; it is assumed to be "
                f"{camera.geometry(*size).position_m[2]:g} m above the floor; --camera-height-m and "
                "--pitch-deg set its pose"
            )
            return camera
        height_m, pitch_deg = round(pose[0], 3), round(math.degrees(pose[1]), 2)
        self.notes.append(
            f"camera: {height_m:.2f} m above the floor, with a pitch of {pitch_deg:.1f} degrees, by the "
            "floor in the depth images; --camera-height-m and --pitch-deg set its pose"
        )
        return replace(
            camera,
            height_m=height_m if camera.height_m is None else camera.height_m,
            pitch_deg=pitch_deg if camera.pitch_deg is None else camera.pitch_deg,
        )

    def __iter__(self) -> Iterator[Frame]:
        """Yield frames with colour and depth of the same instants.

        Raises:
            BadInput: an image is unusable, or depth and colour differ in size.
        """
        calibration = self._camera.calibration(self._geometry.width, self._geometry.height)
        colours, depths = (read_row(paths, self.notes) for paths in (self._pairs.colour, self._pairs.depth))
        for number, (colour, counts) in enumerate(zip(colours, depths, strict=True)):
            if colour.shape[:2] != counts.shape[:2]:
                raise BadInput(
                    f"{self._pairs.depth[number]}: depth must have the size of its colour image, "
                    f"{size_of(colour)}, got {size_of(counts)}"
                )
            depth = self._counts(counts)
            if number == 0:
                self._counts.check_plausible(counts)
            yield Frame(
                images={DEPTH: depth, DEPTH_COLOUR: colour_picture(colour, str(self._options.footage))},
                time_s=self._time_s(number),
                calibrations={DEPTH: calibration},
                odometry=None if self._odometry is None else self._odometry[number],
            )

    def _time_s(self, number: int) -> float:
        times = self._times_s if self._pairs.time_s is None else self._pairs.time_s.tolist()
        return _moment(self._options, self._times_s or times, self._offsets, number, self.rate_hz)

    def picture(self, frame: Frame) -> Picture:
        """Return the colour image of a frame."""
        return frame.rgb(DEPTH_COLOUR)

    def about(self) -> dict[str, Any]:
        """Return the depth scale and the pose of the camera."""
        rgbd = self._rgbd
        return {
            "depth": rgbd.depth.name,
            "depth_scale_m": rgbd.m_per_count,
            "camera": {
                "height_m": self._geometry.position_m[2],
                "pitch_deg": self._camera.pitch_deg or 0.0,
                "focal_px": self._geometry.focal_px,
                "centre_px": self._geometry.centre_px,
            },
            "odometry": None if rgbd.odometry is None else rgbd.odometry.name,
        }


def _given_times(options: TrackOptions, names: Sequence[str]) -> list[float] | None:
    """Return the times of images in a file of time stamps, from 0; None without such a file."""
    if options.timestamps is None:
        return None
    if options.rate_hz is not None:
        raise BadInput("--rate-hz: --timestamps has the images' times; leave one of them out")
    times = read_time_stamps(options.timestamps, names)
    return [float(time) for time in times - times[0]] if len(times) else []


def _rate_of(times_s: Sequence[float] | None) -> float | None:
    """Return the images per second, from the median interval."""
    return 1.0 / float(np.median(np.diff(times_s))) if times_s is not None and len(times_s) > 1 else None


def _moment(
    options: TrackOptions,
    times_s: Sequence[float] | None,
    offsets: Sequence[float] | None,
    number: int,
    rate_hz: float,
) -> float:
    """Return the time of an image: as given, or by the frame rate, with the gaps in its number."""
    if times_s is None:
        return (number if offsets is None else offsets[number]) / rate_hz
    if number >= len(times_s):
        raise BadInput(f"{options.timestamps}: has {len(times_s)} times, but there are more images")
    return times_s[number]


def _paths_of(footage: Footage) -> list[Path]:
    return footage.paths if isinstance(footage, PictureFolder) else []


def _numbers(count: int) -> list[str]:
    return [str(number) for number in range(1, count + 1)]


def _mount_of(options: TrackOptions, lens: Lens | None) -> FootageCamera | None:
    """Return pose and field of view of the thermal camera, which a calibration file can complete."""
    mount = options.mount
    if mount is None:
        return None
    mount = replace(mount, pitch_deg=mount.pitch_deg or 0.0)
    is_known = mount.focal_px is not None or mount.vertical_fov_deg is not None
    if lens is not None and is_known:
        raise BadInput("--calibration has the focal length; leave --focal-px and --vertical-fov-deg out")
    if lens is not None:
        return replace(mount, focal_px=lens.focal_px)
    if not is_known:
        raise BadInput(
            "positions on the floor need --vertical-fov-deg, --focal-px or --calibration beside "
            "--camera-height-m; add one of them"
        )
    return mount


def _check_kind(options: TrackOptions) -> None:
    for option, path in (("--calibration", options.calibration), ("--mask", options.mask)):
        if path is not None:
            raise BadInput(f"{option}: is for thermal images; leave it out, or leave --depth out")
    if options.colour is not None or options.radiometry != Radiometry():
        raise BadInput(
            "--depth: --colour, --temperature-range, --scale and --polarity are for thermal images only; "
            "FOLDER itself holds the colour images"
        )


def _folders(options: TrackOptions, rgbd: RgbdOptions) -> tuple[tuple[Path, str], tuple[Path, str]]:
    """Return both folders, each with the name of its images in a run."""
    assert options.path is not None  # `TrackOptions` refuses depth with a live source
    return (options.path, DEPTH_COLOUR), (rgbd.depth, DEPTH)


def _folder(path: Path, image: str, depth: Path) -> PictureFolder:
    if not path.is_dir():
        raise BadInput(f"{path}: folder not found; colour images and their depth need one folder each")
    if (path / "run.json").is_file():
        raise BadInput(f"{path}: is a run; give {path / image}")
    if image != DEPTH_COLOUR or pictures_in(path):
        return PictureFolder(path, path.name)
    inner = [each for each in folders_in(path) if each.resolve() != depth.resolve()]
    named = [each for each in inner if each.name in _COLOUR_FOLDERS] or inner
    if len(named) == 1:
        return PictureFolder(named[0], path.name)
    if not inner:
        raise BadInput(f"{path}: contains no colour images; give the folder that has them")
    raise BadInput(f"{path}: has images in {', '.join(f'{each.name}/' for each in inner)}; give one of them")


COLOUR_TRACKER: Final = "colour"
"""Tracker that differs from `thermal` only in its use of colour."""


class ThermalViews:
    """Thermal images of a folder, a video or a live source.

    Raises:
        BadInput: the images cannot be read, or the tracker needs colour and there is none.
    """

    camera = THERMAL
    cameras: tuple[str, ...] = (THERMAL, COLOUR)

    def __init__(self, options: TrackOptions) -> None:
        if options.tracker == COLOUR_TRACKER and options.colour is None:
            raise BadInput("--tracker colour: needs --colour FOLDER; add it, or give --tracker thermal")
        self._options = options
        self._images: ThermalImages | None = None
        self._mask = None if options.mask is None else read_mask(options.mask)
        self._lens = None if options.calibration is None else read_lens(options.calibration)
        self._mount = _mount_of(options, self._lens)
        self._footage: Footage
        self.stop: Callable[[], None] | None = None
        if isinstance(options.footage, LiveSource):
            self._footage = live = LiveFootage(options.footage, options.rate_hz)
            self.stop = live.stop
        else:
            self._footage = open_footage(options.footage)
        self._colour = None if options.colour is None else open_footage(options.colour)
        self._pair_up()
        names = [path.name for path in paths] if (paths := _paths_of(self._footage)) else None
        self._times_s = _given_times(options, names or _numbers(self._footage.expected))
        self._offsets = offsets_of(paths)
        if time_stamps(paths) is not None and self._times_s is None:
            use = "used" if options.rate_hz is None else "not used, as --rate-hz says otherwise"
            self._footage.notes.append(f"names of images contain their times, which are {use}")
        self.expected, self.is_exact = self._footage.expected, self._footage.is_exact
        self.numbers = self._footage.numbers
        self.rate_hz = (
            options.rate_hz
            or _rate_of(self._times_s)
            or self._footage.rate_hz
            or self._given_rate()
            or DEFAULT_RATE_HZ
        )

    def _pair_up(self) -> None:
        """Leave out the images of two folders that have no counterpart."""
        if not isinstance(self._footage, PictureFolder) or not isinstance(self._colour, PictureFolder):
            return
        pairs = pair_up(self._footage.paths, self._colour.paths, "colour")
        self._footage.take(pairs.colour)
        self._colour.paths = list(pairs.depth)
        if pairs.note:
            self._footage.notes.append(pairs.note)

    def _time_s(self, number: int) -> float:
        """Return the time of an image, from 0: that of its time stamp, or an even one, with gaps."""
        is_own = self._options.rate_hz is None or isinstance(self._footage, LiveFootage)
        own = self._footage.times_s if is_own else None
        return _moment(self._options, self._times_s or own, self._offsets, number, self.rate_hz)

    def _given_rate(self) -> float | None:
        """Read the frame rate from a file beside the images."""
        footage = self._options.path
        path = None if footage is None else find_info(footage)
        rate = None if path is None else rate_in(path)
        if rate is not None:
            self._footage.notes.append(
                f"{path}: gives the frame rate, {rate:g} Hz; use --rate-hz to override it"
            )
        return rate

    @property
    def notes(self) -> list[str]:
        """Notes on the interpretation of the inputs."""
        colour = [] if self._colour is None else self._colour.notes
        images = [] if self._images is None else self._images.notes
        if self._mount is not None:
            images = [*images, *self._mount.notes]
        return [*self._footage.notes, *images, *colour]

    def __iter__(self) -> Iterator[Frame]:
        """Yield frames with thermal images, and with colour images if there are any.

        Raises:
            BadInput: an image is unusable, or the numbers of thermal and colour images differ.
        """
        pictures = self._pictures()
        first = list(islice(pictures, self._look_ahead))
        self._images = ThermalImages(
            self._radiometry([thermal for thermal, _ in first]),
            by_contrast=uses_contrast(self._options.tracker),
            where=str(self._options.footage),
            mask=self._mask,
            lens=self._lens,
            calibrate=None if self._mount is None else self._mount.calibration,
        )
        for number, (thermal, picture) in enumerate(chain(first, pictures)):
            if number == 0:
                check_start(thermal, self._options)
            colour = None if picture is None else colour_picture(picture, "--colour")
            yield self._images.frame(thermal, self._time_s(number), colour)
        if isinstance(self._footage, LiveFootage):
            self.rate_hz = _rate_of(self._footage.times_s) or self.rate_hz

    @property
    def _look_ahead(self) -> int:
        """Number of images that are needed to begin."""
        radiometry = self._options.radiometry
        is_asked = radiometry.polarity is None and not radiometry.is_known and self.stop is None
        return LOOK_AHEAD if is_asked else 0

    def _radiometry(self, first: Sequence[NDArray[Any]]) -> Radiometry:
        """Return the meaning of the pixels, with the polarity of 8-bit images if it was detected."""
        radiometry = self._options.radiometry
        if not first or first[0].dtype != np.uint8:
            return radiometry
        colours = FalseColours()
        if detect_polarity([colours.grey(image, []) for image in first]) is not Polarity.BLACK_HOT:
            return radiometry
        self._footage.notes.append(
            "people are darker than what is around them, so dark pixels are taken as warm; if people are "
            "colder than it, give --polarity white-hot"
        )
        return replace(radiometry, polarity=Polarity.BLACK_HOT)

    def _pictures(self) -> Iterator[tuple[NDArray[Any], NDArray[Any] | None]]:
        here, there = self._options.footage, self._options.colour
        colours = () if self._colour is None else self._colour
        for number, (thermal, picture) in enumerate(zip_longest(self._footage, colours)):
            if thermal is None or (self._colour is not None and picture is None):
                shorter, longer = (here, there) if thermal is None else (there, here)
                raise BadInput(
                    f"{shorter}: ends after {number} images, before {longer}; both need the same number"
                )
            yield thermal, picture

    def picture(self, frame: Frame) -> Picture:
        """Return the grey image of a frame."""
        return show_thermal(frame.grey(THERMAL))

    def about(self) -> dict[str, Any]:
        """Describe the meaning of the pixel values."""
        colour, radiometry = self._options.colour, self._options.radiometry
        mount, given = self._mount, (self._options.calibration, self._options.mask)
        calibration, mask = (None if path is None else path.name for path in given)
        return {
            "colour": None if colour is None else colour.name,
            "temperature_range_c": radiometry.span_c,
            "scale": radiometry.scale,
            "camera": None if mount is None else asdict(mount),
            "calibration": calibration,
            "mask": mask,
        }


class Views(Protocol):
    """A sequence of frames.

    Attributes:
        camera: name of the camera in whose image boxes are given and drawn.
        cameras: names of all available cameras.
        expected: expected number of frames; a damaged video has fewer.
        is_exact: whether `expected` is exact.
        numbers: numbers in the images' file names, in order; None if there are none.
        rate_hz: frames per second; those of a live source are known after reading.
        stop: ends reading after the present frame; None if only the footage ends it.
    """

    camera: str
    cameras: tuple[str, ...]
    expected: int
    is_exact: bool
    numbers: range | None
    rate_hz: float
    stop: Callable[[], None] | None

    @property
    def notes(self) -> list[str]:
        """Notes on the interpretation of the inputs; complete after reading."""
        ...

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames one by one.

        Raises:
            BadInput: an image is unusable.
        """
        ...

    def picture(self, frame: Frame) -> Picture:
        """Return a frame as a picture for display, (H, W, 3) RGB."""
        ...

    def about(self) -> dict[str, Any]:
        """Describe the images, for run.json."""
        ...


def open_views(options: TrackOptions) -> Views:
    """Open thermal footage, or colour with depth.

    Raises:
        BadInput: the footage cannot be read, or an option is for the other kind.
    """
    return ThermalViews(options) if options.rgbd is None else RgbdViews(options, options.rgbd)
