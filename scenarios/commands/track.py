"""The command `track`: people in footage that others recorded."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import FieldsCommand, GivenOptions, options_of, tell_note
from peopleboy.tracker.trackers import DEFAULT_TRACKER

if TYPE_CHECKING:
    from peopleboy.scenarios.footage.options import RgbdOptions, TrackOptions
    from peopleboy.scenarios.footage.rgbd_camera import RgbdCamera
    from peopleboy.scenarios.footage.track_footage import Tracked

_TRACKERS = (
    "detection, contour, learned, thesis, colour, thermal or paper; rgbd or rgbd-printed with --depth; "
    "or module:Class, your own"
)


@click.command(cls=FieldsCommand)
@click.argument("footage", metavar="FOLDER|TIFF|VIDEO", type=click.Path(path_type=Path))
@options_of("scenarios.footage.options:TrackOptions", "out", "colour", into="files")
@click.option(
    "--temperature-range",
    type=(float, float),
    metavar="LOW HIGH",
    help="degC that 0 and 255 of 8-bit pictures stand for.",
)
@click.option(
    "--scale",
    metavar="GAIN,OFFSET",
    help="16-bit counts to degC: 'centikelvin', or degC = GAIN counts + OFFSET.",
)
@click.option("--black-hot", is_flag=True, help="Warm things are dark.")
@options_of(
    "scenarios.footage.options:RgbdOptions", "depth", "m_per_count", "odometry", into="rgbd", is_optional=True
)
@options_of(
    "scenarios.footage.rgbd_camera:RgbdCamera",
    "height_m",
    "pitch_deg",
    "focal_px",
    "vertical_fov_deg",
    into="camera",
)
@options_of(
    "scenarios.footage.options:TrackOptions",
    *("rate_hz", "tracker", "truth", "boxes", "seed", "film", "overwrite"),
    tracker=f"One of {_TRACKERS}.  [default: detection; rgbd with --depth]",
)
@click.option(
    "--start",
    metavar="X,Y,W,H|truth",
    help="Where a person is in the first picture, to initialise it.",
)
def track(
    footage: Path,
    files: GivenOptions[TrackOptions],
    temperature_range: tuple[float, float] | None,
    scale: str | None,
    black_hot: bool,
    rgbd: GivenOptions[RgbdOptions],
    camera: GivenOptions[RgbdCamera],
    given: GivenOptions[TrackOptions],
    start: str | None,
) -> None:
    """Track people in thermal pictures (PNG, TIFF, JPEG, BMP; 8 or 16 bit) of a folder, or in a video.

    Leaves tracks.txt (MOTChallenge), tracks.parquet, run.json and contact_sheet.png; metrics.json if there is
    truth. Without temperatures the grey follows the scene's contrast. With --depth and --depth-scale, people
    are tracked in colour with depth, and tracks.parquet has their places on the floor.
    """
    from peopleboy.scenarios.footage.options import RGBD_TRACKER
    from peopleboy.scenarios.footage.track_footage import track_footage
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.tracker.footage.grey import Radiometry, parse_scale

    options = given.make(
        footage=footage,
        **files.values,
        radiometry=Radiometry(
            span_c=temperature_range,
            scale=None if scale is None else parse_scale(scale),
            is_inverted=black_hot,
        ),
        rgbd=_rgbd(rgbd, camera),
        tracker=given.tracker or (DEFAULT_TRACKER if rgbd.depth is None else RGBD_TRACKER),
        start=None if start is None else _parse_start(start),
    )
    with progress_bar(footage.name, unit="frames") as show:
        tracked = track_footage(options, lambda frame, expected: show(frame, max(expected, frame)))
    _tell(tracked, options)


def _rgbd(given: GivenOptions[RgbdOptions], camera: GivenOptions[RgbdCamera]) -> RgbdOptions | None:
    if given.depth is None:
        if given.values or camera.values:
            raise BadInput("options of a depth camera need --depth FOLDER; without it, leave them out")
        return None
    if given.m_per_count is None:
        raise BadInput("--depth needs --depth-scale, the metres a count stands for: 0.001 for millimetres")
    return given.make(camera=camera.make())


def _parse_start(text: str) -> tuple[float, float, float, float] | str:
    if text == "truth":
        return text
    try:
        x, y, width, height = (float(part) for part in text.split(","))
    except ValueError:
        raise BadInput(f"--start must be X,Y,W,H in pixels or 'truth', got {text!r}") from None
    if not (width > 0 and height > 0):
        raise BadInput(f"--start must have a width and height above 0, got {text!r}")
    return x, y, width, height


def _tell(tracked: Tracked, options: TrackOptions) -> None:
    from peopleboy.scenarios.footage.track_footage import outcome_lines
    from peopleboy.scenarios.scores.show_scores import print_scores

    for note in tracked.notes:
        tell_note(note)
    if tracked.scores is not None:
        print_scores(tracked.scores)
    for line in outcome_lines(tracked, options):
        click.echo(line)
