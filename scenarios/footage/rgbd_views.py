"""Colour pictures with depth as a tracker sees them, with where their camera stood."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import Picture
from peopleboy.scenarios.footage.checks import check_first, colour_picture
from peopleboy.scenarios.footage.options import DEFAULT_RATE_HZ, RgbdOptions, TrackOptions
from peopleboy.tracker.footage.depth_pictures import DepthCounts, pair_up
from peopleboy.tracker.footage.grey import Radiometry
from peopleboy.tracker.footage.pictures import PictureFolder
from peopleboy.tracker.footage.read_picture import read_picture, read_row, size_of
from peopleboy.tracker.footage.sequence_info import load_odometry
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame, Odometry, PinholeCalibration


class RgbdViews:
    """Two folders of an RGB-D camera.

    Raises:
        BadInput: a folder cannot be read, the pictures of both do not belong together, or an option is one
            for thermal footage.
    """

    camera = DEPTH
    cameras: tuple[str, ...] = (DEPTH, DEPTH_COLOUR)
    is_exact = True

    def __init__(self, options: TrackOptions, rgbd: RgbdOptions) -> None:
        _check_kind(options)
        self._options, self._rgbd = options, rgbd
        self._counts = DepthCounts(rgbd.depth, rgbd.m_per_count)
        folders = [_folder(path, image) for path, image in _folders(options, rgbd)]
        told = [*rgbd.camera.notes, *(note for folder in folders for note in folder.notes)]
        self.notes = list(dict.fromkeys(told))
        self._pairs = pair_up(*(folder.paths for folder in folders))
        self.expected = len(self._pairs.colour)
        self.numbers = folders[0].numbers
        if options.rate_hz is not None and self._pairs.time_s is not None:
            raise BadInput("--rate-hz: the names of the pictures tell their times; leave it out")
        self.rate_hz = options.rate_hz or self._pairs.rate_hz or DEFAULT_RATE_HZ
        self._odometry: list[Odometry] | None = None
        if rgbd.odometry is not None:
            self._odometry = load_odometry(rgbd.odometry, self.expected)
        first = read_picture(self._pairs.colour[0], [])
        check_first(first, options)
        self._geometry = rgbd.camera.geometry(first.shape[1], first.shape[0])

    def __iter__(self) -> Iterator[Frame]:
        """Read colour and depth of the same instants.

        Raises:
            BadInput: a picture that cannot be used, or depth of another size than its colour.
        """
        calibration = PinholeCalibration(self._geometry.intrinsics, self._geometry.robot_from_camera)
        colours, depths = (read_row(paths, self.notes) for paths in (self._pairs.colour, self._pairs.depth))
        for number, (colour, counts) in enumerate(zip(colours, depths, strict=True)):
            if colour.shape[:2] != counts.shape[:2]:
                raise BadInput(
                    f"{self._pairs.depth[number]}: depth must be of the pixels of its colour picture, "
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
        times = self._pairs.time_s
        return number / self.rate_hz if times is None else float(times[number])

    def picture(self, frame: Frame) -> Picture:
        """Show the colours of a frame."""
        return frame.rgb(DEPTH_COLOUR)

    def about(self) -> dict[str, Any]:
        """Say how counts became metres, and where the camera stood."""
        rgbd = self._rgbd
        return {
            "depth": rgbd.depth.name,
            "depth_scale_m": rgbd.m_per_count,
            "camera": {
                "height_m": rgbd.camera.height_m,
                "pitch_deg": rgbd.camera.pitch_deg,
                "focal_px": self._geometry.focal_px,
                "centre_px": self._geometry.centre_px,
            },
            "odometry": None if rgbd.odometry is None else rgbd.odometry.name,
        }


def _check_kind(options: TrackOptions) -> None:
    if options.colour is not None or options.radiometry != Radiometry():
        raise BadInput(
            "--depth: --colour, --temperature-range, --scale and --black-hot are for thermal pictures; "
            "the folder itself holds the colour ones"
        )


def _folders(options: TrackOptions, rgbd: RgbdOptions) -> tuple[tuple[Path, str], tuple[Path, str]]:
    """Give both folders, each with what a run calls it."""
    return (options.footage, DEPTH_COLOUR), (rgbd.depth, DEPTH)


def _folder(path: Path, image: str) -> PictureFolder:
    if not path.is_dir():
        raise BadInput(f"{path}: there is no such folder; colour pictures and their depth are in one each")
    if (path / "run.json").is_file():
        raise BadInput(f"{path}: is a run; give {path / image}")
    return PictureFolder(path, path.name)
