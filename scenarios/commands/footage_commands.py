"""Commands for images and tracks of others: `track`, `import-tracks`, `sim-to-real`."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import (
    PATH,
    FieldsCommand,
    GivenOptions,
    WholeNumber,
    options_of,
    tell_note,
)
from peopleboy.tracker.trackers import DEFAULT_TRACKER

if TYPE_CHECKING:
    from peopleboy.scenarios.finished_runs.import_tracks import TrackImport
    from peopleboy.scenarios.footage.options import RgbdCamera, RgbdOptions, TrackOptions
    from peopleboy.scenarios.footage.track_footage import Tracked
    from peopleboy.tracker.footage.grey import Radiometry


_TRACKERS = (
    "detection, contour, learned, thesis, colour, thermal or paper; rgbd or rgbd-printed with --depth; "
    "or module:Class, your own"
)


@click.command(cls=FieldsCommand)
@click.argument("footage", metavar="FOLDER|TIFF|VIDEO", type=PATH)
@options_of("scenarios.footage.options:TrackOptions", "out", "colour", into="files")
@options_of("tracker.footage.grey:Radiometry", "span_c", "is_inverted", into="thermal")
@click.option(
    "--scale",
    metavar="GAIN,OFFSET",
    help="16-bit counts to degC: 'centikelvin', or degC = GAIN counts + OFFSET.",
)
@options_of(
    "scenarios.footage.options:RgbdOptions", "depth", "m_per_count", "odometry", into="rgbd", is_optional=True
)
@options_of(
    "scenarios.footage.options:RgbdCamera",
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
    thermal: GivenOptions[Radiometry],
    scale: str | None,
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
    from peopleboy.scenarios.footage.options import RGBD_TRACKER, parse_start
    from peopleboy.scenarios.footage.track_footage import track_footage
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.tracker.footage.grey import parse_scale

    options = given.make(
        footage=footage,
        **files.values,
        radiometry=thermal.make(scale=None if scale is None else parse_scale(scale)),
        rgbd=_rgbd(rgbd, camera),
        tracker=given.tracker or (DEFAULT_TRACKER if rgbd.depth is None else RGBD_TRACKER),
        start=None if start is None else parse_start(start),
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


def _tell(tracked: Tracked, options: TrackOptions) -> None:
    from peopleboy.scenarios.footage.track_footage import outcome_lines
    from peopleboy.scenarios.scores.show_scores import print_scores

    for note in tracked.notes:
        tell_note(note)
    if tracked.scores is not None:
        print_scores(tracked.scores)
    for line in outcome_lines(tracked, options):
        click.echo(line)


@click.command("import-tracks", cls=FieldsCommand)
@click.argument("run", metavar="RUN", type=PATH)
@click.argument("tracks", metavar="TRACKS", type=PATH)
@options_of(
    "scenarios.finished_runs.import_tracks:TrackImport",
    *("name", "camera", "out", "boxes", "record", "overwrite"),
    out="Folder to leave.  [default: beside RUN, SCENARIO-SEED-NAME, or RUN-NAME for a folder of runs]",
)
def import_tracks(run: Path, tracks: Path, given: GivenOptions[TrackImport]) -> None:
    """Import tracks that another program made of the images of RUN, as a run of their own.

    TRACKS is MOTChallenge text: frame, id, left, top, width, height, confidence, -1, -1, -1; frames are
    the camera's images, counted 1, 2, 3 ... as exports do, and boxes in pixels of them. Leaves a folder with
    RUN's scenario and truth and with these tracks, which report, view, evaluate and export take like any
    other. Status and place on the floor, which such text does not hold, are marked as unknown. The images are
    rendered again, and are those of RUN.

    RUN may be a folder of runs, such as a sweep's. TRACKS is one of files then, SCENARIO-SEED.txt for each
    of them, as benchmarks ask for; those files may lie in a folder data in it.
    """
    from peopleboy.scenarios.finished_runs.import_tracks import import_tracks as take
    from peopleboy.scenarios.finished_runs.import_tracks import imports_by_sequence
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.scenarios.scores.run_scores import headline
    from peopleboy.scenarios.scores.show_scores import print_scores

    out = given.out or run.resolve().parent / f"{_title(run, tracks)}-{given.name}"
    what = given.make(run=run, tracks=tracks, out=out)
    each = imports_by_sequence(what) if tracks.is_dir() else [what]
    for one in each:
        with progress_bar(one.out.name, unit="frames") as show:
            scores = take(one, show)
        if len(each) == 1:
            print_scores(scores.people)
        click.echo(f"{one.tracks.stem}: {headline(scores)}")
        for note in scores.notes:
            tell_note(note)
    click.echo("Status and place on the floor of these tracks are unknown.")
    click.echo(what.out)


def _title(run: Path, tracks: Path) -> str:
    from peopleboy.scenarios.run_folder.finished_run import open_run

    if tracks.is_dir():
        return run.resolve().name
    about = open_run(run).about
    return f"{about.scenario}-{about.seed}"


@click.command("sim-to-real")
@click.argument("rendered", metavar="RENDERED...", nargs=-1, required=True, type=PATH)
@click.option(
    "--real",
    metavar="FOLDER",
    multiple=True,
    required=True,
    type=PATH,
    help="A real clip, or a folder of some; can be given again.",
)
@click.option("--out", type=PATH, default=Path("comparison.html"), show_default=True, help="The page.")
@click.option("--json", "as_json", is_flag=True, help="Print all figures as JSON.")
@click.option("--seed", type=WholeNumber(min=0), default=0, show_default=True, help="Of what is chosen.")
def sim_to_real(rendered: Sequence[Path], real: Sequence[Path], out: Path, as_json: bool, seed: int) -> None:
    """Set rendered thermal pictures beside real ones, and say how well a classifier separates them.

    RENDERED are folders of runs with pictures, or sets of them. A real clip is a folder with pictures in it
    or in thermal/, 8-bit grey, and gt.txt of the MOTChallenge format, or VOT's or OTB's. Both sides need two
    scenes at least. Needs scikit-learn.
    """
    from peopleboy.scenarios.report.page_parts import check_place
    from peopleboy.scenarios.sim_to_real.compare import compare_images as compare
    from peopleboy.scenarios.sim_to_real.page import HEADS, headline, table_rows, write_comparison

    check_place(out)
    found = compare(rendered, real, seed)
    write_comparison(found, out)
    if as_json:
        click.echo(json.dumps(found.to_json(), indent=2))
        return
    for name, side in (("rendered", found.rendered), ("real", found.real)):
        for row in table_rows(name, side)[:1]:
            click.echo(f"{name}: " + ", ".join(f"{h} {v}" for h, v in zip(HEADS[1:], row[1:], strict=True)))
    click.echo(headline(found))
    if found.lacking:
        click.echo(f"{found.lacking}.")
    click.echo(out)
