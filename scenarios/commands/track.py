"""The command `track`: people in footage that others recorded."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.options import BOXES, Number, WholeNumber, tell_note

if TYPE_CHECKING:
    from peopleboy.scenarios.footage.options import RgbdOptions, TrackOptions
    from peopleboy.scenarios.footage.track_footage import Tracked

_TRACKERS = (
    "detection, contour, learned, thesis, colour, thermal or paper; rgbd or rgbd-printed with --depth; "
    "or module:Class, your own"
)


@click.command()
@click.argument("footage", metavar="FOLDER|TIFF|VIDEO", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder to leave.")
@click.option("--colour", type=click.Path(path_type=Path), help="The same view in colour, as many pictures.")
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
@click.option(
    "--rate-hz",
    type=Number(min=0.1, max=1000.0),
    help="Pictures a second.  [default: the video's own, or seqinfo.ini's; 15 otherwise]",
)
@click.option(
    "--depth",
    type=click.Path(path_type=Path),
    help="Folder of 16-bit depth pictures; FOLDER then holds the colours of the same pixels.",
)
@click.option("--depth-scale", type=float, metavar="M", help="Metres a count stands for; 0.001: millimetres.")
@click.option("--camera-height-m", type=float, help="Of the depth camera above the floor.  [default: 1.2]")
@click.option("--pitch-deg", type=float, help="By which it looks down.  [default: 0]")
@click.option("--focal-px", type=float, help="Focal length of its pictures; or the next.")
@click.option("--vertical-fov-deg", type=float, help="From top to bottom of its pictures.  [default: 43]")
@click.option(
    "--odometry",
    type=click.Path(path_type=Path),
    help="CSV file of how it moved: advance_m, aside_m, turn_deg for each picture.  [default: it stands]",
)
@click.option("--tracker", help=f"One of {_TRACKERS}.  [default: detection; rgbd with --depth]")
@click.option(
    "--truth",
    type=click.Path(path_type=Path),
    help="VOT, OTB or MOTChallenge truth.  [default: what lies beside the pictures]",
)
@click.option(
    "--boxes",
    type=BOXES,
    help="As wide as the torso, or as all of a person.  [default: as the truth's are; whole without truth]",
)
@click.option(
    "--start",
    metavar="X,Y,W,H|truth",
    help="Where a person is in the first picture, as trackers of single objects are told.",
)
@click.option("--seed", type=WholeNumber(min=0), default=0, show_default=True, help="Of all that is random.")
@click.option("--film", is_flag=True, help="Write overlay.mp4 too; needs the package av.")
@click.option("--overwrite", is_flag=True, help="Replace an earlier run in the folder.")
def track(
    footage: Path,
    out: Path,
    colour: Path | None,
    temperature_range: tuple[float, float] | None,
    scale: str | None,
    black_hot: bool,
    rate_hz: float | None,
    depth: Path | None,
    depth_scale: float | None,
    camera_height_m: float | None,
    pitch_deg: float | None,
    focal_px: float | None,
    vertical_fov_deg: float | None,
    odometry: Path | None,
    tracker: str | None,
    truth: Path | None,
    boxes: str | None,
    start: str | None,
    seed: int,
    film: bool,
    overwrite: bool,
) -> None:
    """Track people in thermal pictures (PNG, TIFF, JPEG, BMP; 8 or 16 bit) of a folder, or in a video.

    Leaves tracks.txt (MOTChallenge), tracks.parquet, run.json and contact_sheet.png; metrics.json if there is
    truth. Without temperatures the grey follows the scene's contrast. With --depth and --depth-scale, people
    are tracked in colour with depth, and tracks.parquet has their places on the floor.
    """
    from peopleboy.scenarios.footage.options import RGBD_TRACKER, TrackOptions
    from peopleboy.scenarios.footage.track_footage import track_footage
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.tracker.footage.box_kinds import BoxKind
    from peopleboy.tracker.footage.grey import Radiometry, parse_scale
    from peopleboy.tracker.trackers import DEFAULT_TRACKER

    camera = {
        "height_m": camera_height_m,
        "pitch_deg": pitch_deg,
        "focal_px": focal_px,
        "vertical_fov_deg": vertical_fov_deg,
    }
    options = TrackOptions(
        footage=footage,
        out=out,
        colour=colour,
        radiometry=Radiometry(
            span_c=temperature_range,
            scale=None if scale is None else parse_scale(scale),
            is_inverted=black_hot,
        ),
        rgbd=_rgbd(depth, depth_scale, camera, odometry),
        rate_hz=rate_hz,
        tracker=tracker or (DEFAULT_TRACKER if depth is None else RGBD_TRACKER),
        truth=truth,
        boxes=None if boxes is None else BoxKind(boxes),
        start=None if start is None else _parse_start(start),
        seed=seed,
        film=film,
        overwrite=overwrite,
    )
    with progress_bar(footage.name, unit="frames") as show:
        tracked = track_footage(options, lambda frame, expected: show(frame, max(expected, frame)))
    _tell(tracked, options)


def _rgbd(
    depth: Path | None, depth_scale: float | None, camera: Mapping[str, float | None], odometry: Path | None
) -> RgbdOptions | None:
    from peopleboy.scenarios.footage.options import RgbdOptions
    from peopleboy.scenarios.footage.rgbd_camera import RgbdCamera

    told = {name: value for name, value in camera.items() if value is not None}
    if depth is None:
        if told or depth_scale is not None or odometry is not None:
            raise BadInput("options of a depth camera need --depth FOLDER; without it, leave them out")
        return None
    if depth_scale is None:
        raise BadInput("--depth needs --depth-scale, the metres a count stands for: 0.001 for millimetres")
    return RgbdOptions(depth=depth, m_per_count=depth_scale, camera=RgbdCamera(**told), odometry=odometry)


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
