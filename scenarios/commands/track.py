"""The command `track`: people in footage that others recorded."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from peopleboy.bad_input import BadInput

if TYPE_CHECKING:
    from peopleboy.scenarios.footage.track_footage import Tracked, TrackOptions

_TRACKERS = "footage, peopleboy, learned, thesis, colour, thermal or paper; or module:Class, your own"


@click.command()
@click.argument("footage", metavar="FOLDER|VIDEO", type=click.Path(path_type=Path))
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
    type=click.FloatRange(min=0.1, max=1000.0),
    help="Pictures a second.  [default: the video's own; 15 for a folder]",
)
@click.option("--tracker", default="footage", show_default=True, help=f"One of {_TRACKERS}.")
@click.option(
    "--truth",
    type=click.Path(path_type=Path),
    help="VOT, OTB or MOTChallenge truth.  [default: what lies beside the pictures]",
)
@click.option(
    "--start",
    metavar="X,Y,W,H|truth",
    help="Where a person is in the first picture, as trackers of single objects are told.",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of all that is random."
)
@click.option("--film", is_flag=True, help="Write overlay.mp4 too; needs .[export].")
@click.option("--overwrite", is_flag=True, help="Replace an earlier run in the folder.")
def track(
    footage: Path,
    out: Path,
    colour: Path | None,
    temperature_range: tuple[float, float] | None,
    scale: str | None,
    black_hot: bool,
    rate_hz: float | None,
    tracker: str,
    truth: Path | None,
    start: str | None,
    seed: int,
    film: bool,
    overwrite: bool,
) -> None:
    """Track people in a folder of thermal pictures (PNG, TIFF, JPEG, BMP; 8 or 16 bit) or in a video.

    Leaves tracks.txt (MOTChallenge), tracks.parquet, run.json and contact_sheet.png; metrics.json if there is
    truth. Without temperatures the grey follows the scene's contrast.
    """
    from peopleboy.scenarios.footage.track_footage import TrackOptions, track_footage
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.tracker.footage.grey import Radiometry, parse_scale

    options = TrackOptions(
        footage=footage,
        out=out,
        colour=colour,
        radiometry=Radiometry(
            span_c=temperature_range,
            scale=None if scale is None else parse_scale(scale),
            is_inverted=black_hot,
        ),
        rate_hz=rate_hz,
        tracker=tracker,
        truth=truth,
        start=None if start is None else _parse_start(start),
        seed=seed,
        film=film,
        overwrite=overwrite,
    )
    with progress_bar(footage.name, unit="frames") as show:
        tracked = track_footage(options, lambda frame, expected: show(frame, max(expected, frame)))
    _tell(tracked, options)


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
    from peopleboy.scenarios.footage.outcome import outcome_lines
    from peopleboy.scenarios.scores.show_scores import print_scores

    for note in tracked.notes:
        click.echo(f"peopleboy: note: {note}", err=True)
    if tracked.scores is not None:
        print_scores(tracked.scores)
    for line in outcome_lines(tracked, options):
        click.echo(line)
