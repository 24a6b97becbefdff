"""Read colour and depth images of an RGB-D camera as frames."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import Picture
from peopleboy.scenarios.footage.frame_times import given_times, rate_of, time_of
from peopleboy.scenarios.footage.options import (
    DEFAULT_RATE_HZ,
    FootageCamera,
    RgbdOptions,
    TrackOptions,
    colour_picture,
    refuse_thermal_options,
)
from peopleboy.tracker.footage.depth_pictures import DepthCounts, pair_up
from peopleboy.tracker.footage.image_sequences import PictureFolder, folders_in
from peopleboy.tracker.footage.picture_names import offsets_of, pictures_in
from peopleboy.tracker.footage.read_picture import read_picture, read_row, size_of
from peopleboy.tracker.footage.sequence_info import load_odometry
from peopleboy.tracker.footage.thermal_images import check_image
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame, Odometry
from peopleboy.tracker.sensors.depth.depth_view import DepthView
from peopleboy.tracker.sensors.depth.v_disparity import estimate_camera_pose

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
        refuse_thermal_options(options, "--depth")
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
        self._times_s = given_times(options, [path.name for path in self._pairs.colour])
        self.rate_hz = rate_of(self._times_s) or self.rate_hz
        self._offsets = offsets_of(self._pairs.colour)
        self._odometry: list[Odometry] | None = None
        if options.odometry is not None:
            self._odometry = load_odometry(options.odometry, self.expected)
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
        return time_of(self._options, self._times_s or times, self._offsets, number, self.rate_hz)

    def picture(self, frame: Frame) -> Picture:
        """Return the colour image of a frame."""
        return frame.rgb(DEPTH_COLOUR)

    def about(self) -> dict[str, Any]:
        """Return the depth scale and the pose of the camera."""
        odometry = self._options.odometry
        return {
            "depth": self._rgbd.depth.name,
            "depth_scale_m": self._rgbd.m_per_count,
            "camera": {
                "height_m": self._geometry.position_m[2],
                "pitch_deg": self._camera.pitch_deg or 0.0,
                "focal_px": self._geometry.focal_px,
                "centre_px": self._geometry.centre_px,
            },
            "odometry": None if odometry is None else odometry.name,
        }


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
