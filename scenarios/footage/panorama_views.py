"""Read the images of a 360-degree camera as frames."""

from collections.abc import Callable, Iterator
from typing import Any

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import Picture
from peopleboy.scenarios.footage.frame_times import given_times, rate_of, time_of
from peopleboy.scenarios.footage.options import (
    DEFAULT_RATE_HZ,
    PanoramaOptions,
    TrackOptions,
    colour_picture,
    refuse_thermal_options,
)
from peopleboy.tracker.footage.image_sequences import PictureFolder, open_footage
from peopleboy.tracker.footage.picture_names import offsets_of
from peopleboy.tracker.footage.read_picture import size_of
from peopleboy.tracker.footage.sequence_info import load_odometry
from peopleboy.tracker.frame import PANORAMA, Frame
from peopleboy.tracker.sensors.panorama.unrolling import PanoramaUnrolling


class PanoramaViews:
    """Images of a 360-degree camera, from a folder or a video.

    Raises:
        BadInput: the images cannot be read, or an option is for thermal footage only.
    """

    camera = PANORAMA
    cameras: tuple[str, ...] = (PANORAMA,)
    stop: Callable[[], None] | None = None

    def __init__(self, options: TrackOptions, panorama: PanoramaOptions) -> None:
        refuse_thermal_options(options, "--panorama")
        assert options.path is not None  # `TrackOptions` refuses panoramas of a live source
        self._options, self._panorama = options, panorama
        self._footage = open_footage(options.path)
        self._unrolling: PanoramaUnrolling | None = None
        self.expected, self.is_exact = self._footage.expected, self._footage.is_exact
        self.numbers = self._footage.numbers
        paths = self._footage.paths if isinstance(self._footage, PictureFolder) else []
        names = [path.name for path in paths] or [str(k + 1) for k in range(self.expected)]
        self._times_s, self._offsets = given_times(options, names), offsets_of(paths)
        rate_hz = options.rate_hz or rate_of(self._times_s) or self._footage.rate_hz
        self.rate_hz = rate_hz or DEFAULT_RATE_HZ
        odometry = options.odometry
        self._odometry = None if odometry is None else load_odometry(odometry, self.expected)

    @property
    def notes(self) -> list[str]:
        """Notes on the interpretation of the inputs."""
        return self._footage.notes

    def __iter__(self) -> Iterator[Frame]:
        """Yield frames with panoramas, whose columns are directions.

        Raises:
            BadInput: an image is unusable, or has another size than the first.
        """
        where = str(self._options.footage)
        for number, read in enumerate(self._footage):
            picture = colour_picture(read, where)
            size = picture.shape[1], picture.shape[0]
            if self._unrolling is None:
                given = self._panorama
                self._unrolling = PanoramaUnrolling.of(given.kind, size, given.elevation_deg, given.height_m)
            if size != self._unrolling.size:
                first = "x".join(map(str, self._unrolling.size))
                raise BadInput(f"{where}: must have the size of the first, {first}, got {size_of(picture)}")
            if self._odometry is not None and number >= len(self._odometry):
                raise BadInput(f"{self._options.odometry}: has {number} rows, but there are more images")
            own = self._footage.times_s if self._options.rate_hz is None else None
            yield Frame(
                images={PANORAMA: self._unrolling.image(picture)},
                time_s=time_of(self._options, self._times_s or own, self._offsets, number, self.rate_hz),
                calibrations={PANORAMA: self._unrolling.calibration},
                odometry=None if self._odometry is None else self._odometry[number],
            )

    def picture(self, frame: Frame) -> Picture:
        """Return the panorama of a frame."""
        return frame.rgb(PANORAMA)

    def about(self) -> dict[str, Any]:
        """Return the kind of the images, and the height of the camera."""
        odometry = self._options.odometry
        return {
            "panorama": str(self._panorama.kind),
            "elevation_deg": self._panorama.elevation_deg,
            "camera": {"height_m": self._panorama.height_m},
            "odometry": None if odometry is None else odometry.name,
        }
