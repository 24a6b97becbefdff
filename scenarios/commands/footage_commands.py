"""Commands for recorded images and imported tracks: `track`, `import-tracks`, `sim-to-real`."""

import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import (
    DETECTOR,
    PATH,
    FieldsCommand,
    GivenOptions,
    Output,
    PlainPath,
    WholeNumber,
    options_of,
    output_options,
    print_note,
)
from peopleboy.tracker.tracker_names import with_detector
from peopleboy.tracker.trackers import DEFAULT_TRACKER, LIVE_TRACKER

if TYPE_CHECKING:
    from peopleboy.scenarios.finished_runs.import_tracks import TrackImport
    from peopleboy.scenarios.footage.options import (
        FootageCamera,
        PanoramaOptions,
        RawOptions,
        RgbdOptions,
        TrackOptions,
    )
    from peopleboy.scenarios.footage.track_footage import ShowTracks, Tracked
    from peopleboy.tracker.footage.grey import Radiometry
    from peopleboy.tracker.footage.live_footage import LiveSource


_TRACKERS = (
    "detection, detection-live, contour, learned, thesis, colour, thermal, paper, rgbd or rgbd-printed (both "
    "with --depth), panoramic (with --panorama), or module:Class (your own)"
)


class _Footage(PlainPath):
    """A path as `PlainPath`, or a live source, as text."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        from peopleboy.tracker.footage.live_footage import is_live

        return value if is_live(value) else str(super().convert(value, param, ctx))


@click.command(cls=FieldsCommand)
@click.argument("footage", metavar="FOLDER|TIFF|VIDEO|CAMERA|STREAM|-", type=_Footage())
@options_of("scenarios.footage.options:TrackOptions", "out", "colour", "calibration", "mask", into="files")
@options_of("scenarios.footage.options:RawOptions", "size", "pixels", into="raw")
@click.option(
    "--live",
    is_flag=True,
    help="Show images and tracks in the rerun viewer while tracking; without a display, on a local web page.",
)
@options_of("tracker.footage.grey:Radiometry", "span_c", "polarity", into="thermal")
@click.option(
    "--scale",
    metavar="GAIN,OFFSET",
    help="Conversion of 16-bit counts to degC: degC = GAIN * counts + OFFSET, or the word centikelvin.",
)
@options_of("scenarios.footage.options:RgbdOptions", "depth", "m_per_count", into="rgbd", is_optional=True)
@options_of(
    "scenarios.footage.options:PanoramaOptions", "kind", "elevation_deg", into="panorama", is_optional=True
)
@options_of(
    "scenarios.footage.options:FootageCamera",
    "height_m",
    "pitch_deg",
    "focal_px",
    "vertical_fov_deg",
    into="camera",
)
@options_of(
    "scenarios.footage.options:TrackOptions",
    *(
        "rate_hz",
        "timestamps",
        "odometry",
        "tracker",
        "gallery",
        "truth",
        "protocol",
        "boxes",
        "seed",
        "video",
    ),
    "overwrite",
    tracker=f"Tracker to use: {_TRACKERS}.  [default: detection, detection-live for a live source, rgbd with "
    "--depth, or panoramic with --panorama]",
)
@click.option("--detector", help=DETECTOR)
@click.option(
    "--start",
    metavar="X,Y,W,H|truth",
    help="Initialise the tracker with the box of a person in the first image, in pixels or from the "
    "ground truth.",
)
@output_options
def track(
    footage: str,
    files: "GivenOptions[TrackOptions]",
    raw: "GivenOptions[RawOptions]",
    live: bool,
    thermal: "GivenOptions[Radiometry]",
    scale: str | None,
    rgbd: "GivenOptions[RgbdOptions]",
    panorama: "GivenOptions[PanoramaOptions]",
    camera: "GivenOptions[FootageCamera]",
    given: "GivenOptions[TrackOptions]",
    detector: str | None,
    start: str | None,
    output: Output,
) -> None:
    """Track people in thermal images, a video or a live camera.

    FOLDER contains PNG, TIFF, JPEG or BMP images with 8 or 16 bits. The command writes tracks.txt
    (MOTChallenge), tracks.parquet, run.json, contact_sheet.png and, if there is ground truth, metrics.json.
    If temperatures are unknown, grey levels are stretched to the contrast of the scene.

    CAMERA is a number, such as 0, or a device, such as /dev/video0. STREAM is an address, such as
    rtsp://camera/stream. With -, encoded video or, with --size and --pixels, raw images are read from
    standard input. The tracks of live images are also printed as JSON, one line per image. Images that come
    while one is processed are dropped. Ctrl-C ends the tracking, and the files are written.

    With --depth and --depth-scale, people are tracked in colour and depth images, and tracks.parquet contains
    their floor positions. With --panorama and --camera-height-m, people are tracked all around an upright
    360-degree camera, with their floor positions.
    """
    from peopleboy.scenarios.footage.options import PANORAMA_TRACKER, RGBD_TRACKER, parse_start
    from peopleboy.tracker.footage.grey import parse_scale

    source = _source(footage, raw)
    usual = DEFAULT_TRACKER if isinstance(source, Path) else LIVE_TRACKER
    is_thermal = rgbd.depth is None and panorama.kind is None
    usual = usual if panorama.kind is None else PANORAMA_TRACKER
    tracker = given.tracker or (usual if rgbd.depth is None else RGBD_TRACKER)
    options = given.make(
        footage=source,
        **{**files.values, "out": files.out or _default_out(source)},
        radiometry=thermal.make(scale=None if scale is None else parse_scale(scale)),
        rgbd=_rgbd(rgbd, camera),
        panorama=_panorama(panorama, rgbd, camera),
        mount=_mount(camera) if is_thermal else None,
        tracker=with_detector(tracker, detector),
        start=None if start is None else parse_start(start),
    )
    _track(options, output, is_shown=live)


def _source(footage: str, raw: "GivenOptions[RawOptions]") -> "Path | LiveSource":
    from peopleboy.tracker.footage.live_footage import LiveSource, is_live

    layout = raw.make().layout()
    if is_live(footage):
        return LiveSource(footage, layout)
    if layout is not None:
        raise BadInput(f"{footage}: --size and --pixels are for raw images on standard input; give - for it")
    return Path(footage)


def _default_out(source: "Path | LiveSource") -> Path:
    if isinstance(source, Path):
        raise click.MissingParameter(param_type="option", param_hint="--out")
    return Path("runs") / time.strftime("live-%Y%m%d-%H%M%S")


def _track(options: "TrackOptions", output: Output, *, is_shown: bool) -> None:
    """Track, show the tracks on the way as asked for, and print a summary."""
    from peopleboy.scenarios.footage.track_footage import track_footage
    from peopleboy.scenarios.footage.track_lines import TrackLines
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.scenarios.recording.recording_file import check_installed

    if options.path is None and output.as_json:
        raise BadInput("--json: tracks of a live source are printed as JSON anyway; leave it out")
    if is_shown:
        check_installed("--live")
    with ExitStack() as stack:
        shows: list[ShowTracks] = []
        if options.path is None and output.is_text:
            shows.append(TrackLines(options.camera).show)
        if is_shown:
            from peopleboy.scenarios.recording.live_tracks import live_tracks

            shows.append(stack.enter_context(live_tracks(print_note, options.camera)))
        report = stack.enter_context(progress_bar(options.name, unit="frames"))
        tracked = track_footage(options, lambda frame, expected: report(frame, max(expected, frame)), shows)
    _print(tracked, options, output)


def _mount(camera: "GivenOptions[FootageCamera]") -> "FootageCamera | None":
    if not camera.values:
        return None
    if camera.height_m is None:
        raise BadInput(
            "positions on the floor need --camera-height-m; add it, or leave the camera's options out"
        )
    return camera.make()


def _rgbd(given: "GivenOptions[RgbdOptions]", camera: "GivenOptions[FootageCamera]") -> "RgbdOptions | None":
    if given.depth is None:
        if given.values:
            raise BadInput("options of depth images need --depth FOLDER; add it, or leave them out")
        return None
    if given.m_per_count is None:
        raise BadInput("--depth needs --depth-scale, the metres per count: 0.001 for millimetres")
    return given.make(camera=camera.make())


def _panorama(
    given: "GivenOptions[PanoramaOptions]",
    rgbd: "GivenOptions[RgbdOptions]",
    camera: "GivenOptions[FootageCamera]",
) -> "PanoramaOptions | None":
    if given.kind is None:
        if given.values:
            raise BadInput("--elevation-deg: is for panoramas; add --panorama KIND, or leave it out")
        return None
    if rgbd.depth is not None:
        raise BadInput("--panorama and --depth are for different cameras; give only one")
    if camera.height_m is None or len(camera.values) > 1:
        raise BadInput(
            "--panorama: needs --camera-height-m, the camera's height above the floor, and no other options "
            "of the camera"
        )
    return given.make(height_m=camera.height_m)


def _print(tracked: "Tracked", options: "TrackOptions", output: Output) -> None:
    from peopleboy.scenarios.footage.track_footage import outcome_lines
    from peopleboy.scenarios.scores.tables.show_scores import print_scores
    from peopleboy.tracker.evaluation.table import to_json

    for note in tracked.notes:
        print_note(note)

    def show() -> None:
        if tracked.scores is not None:
            print_scores(tracked.scores)
        for line in outcome_lines(tracked, options):
            click.echo(line, err=options.path is None)

    metrics = {} if tracked.scores is None else {"metrics": to_json(tracked.scores)}
    output.results(lambda: {"out": str(options.out), "notes": list(tracked.notes)} | metrics, show)


@click.command("import-tracks", cls=FieldsCommand)
@click.argument("run", metavar="RUN", type=PATH)
@click.argument("tracks", metavar="TRACKS", type=PATH)
@options_of(
    "scenarios.finished_runs.import_tracks:TrackImport",
    *("name", "camera", "out", "boxes", "record", "overwrite"),
    out="Output folder.  [default: SCENARIO-SEED-NAME next to RUN, or RUN-NAME for a folder of runs]",
)
@output_options
def import_tracks(run: Path, tracks: Path, given: "GivenOptions[TrackImport]", output: Output) -> None:
    """Import tracks that another program computed for a run.

    TRACKS is a MOTChallenge text file with the columns frame, id, left, top, width, height, confidence, -1,
    -1, -1. Frames are the camera's images, counted from 1 as in exports, and boxes are in pixels.

    The command writes a run folder with RUN's scenario and ground truth and the imported tracks. You can use
    this folder with report, view, evaluate and export. The images are rendered again, and are bit-identical
    to those of RUN. The tracks' status and floor position are marked as unknown, because MOTChallenge files
    contain neither.

    RUN can also be a folder of runs, such as the output of a sweep. TRACKS is then a folder with one file
    SCENARIO-SEED.txt per run, directly or in a subfolder `data`.
    """
    from peopleboy.scenarios.finished_runs.import_tracks import import_tracks as take
    from peopleboy.scenarios.finished_runs.import_tracks import imports_by_sequence
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.scenarios.scores.run_scores import headline
    from peopleboy.scenarios.scores.tables.show_scores import print_scores

    out = given.out or run.resolve().parent / f"{_title(run, tracks)}-{given.name}"
    what = given.make(run=run, tracks=tracks, out=out)
    each = imports_by_sequence(what) if tracks.is_dir() else [what]
    found = []
    for one in each:
        with progress_bar(one.out.name, unit="frames") as show:
            scores = take(one, show)
        found.append({"run": str(one.out), "notes": list(scores.notes), "metrics": scores.to_json()})
        if output.is_text:
            if len(each) == 1:
                print_scores(scores.people)
            click.echo(f"{one.tracks.stem}: {headline(scores)}")
        for note in scores.notes:
            print_note(note)
    unknown = "Status and position on the floor of these tracks are unknown."
    output.lines({"out": what.out, "runs": found}, unknown, what.out)


def _title(run: Path, tracks: Path) -> str:
    from peopleboy.scenarios.run_folder.finished_run import open_run

    if tracks.is_dir():
        return run.resolve().name
    about = open_run(run).about
    return f"{about.scenario}-{about.seed}"


@click.command("sim-to-real", cls=FieldsCommand)
@click.argument("rendered", metavar="RENDERED...", nargs=-1, required=True, type=PATH)
@click.option(
    "--real",
    metavar="FOLDER",
    multiple=True,
    required=True,
    type=PATH,
    help="A real clip, or a folder of clips. Can be given several times.",
)
@click.option(
    "--out", type=PATH, default=Path("comparison.html"), show_default=True, help="Path of the HTML page."
)
@click.option(
    "--seed", type=WholeNumber(min=0), default=0, show_default=True, help="Random seed for sampling."
)
@output_options
def sim_to_real(rendered: Sequence[Path], real: Sequence[Path], out: Path, seed: int, output: Output) -> None:
    """Measure the sim-to-real gap of rendered thermal images.

    The gap is measured by how well a classifier separates rendered from real images. RENDERED are run folders
    with images, or rendered data sets. A real clip is a folder with 8-bit grey images, either directly or in
    a subfolder thermal, and gt.txt in MOTChallenge, VOT or OTB format. The rendered and the real images must
    each come from at least two scenes. The command needs scikit-learn.
    """
    from peopleboy.scenarios.report.page_parts import check_place
    from peopleboy.scenarios.sim_to_real.compare import compare_images as compare
    from peopleboy.scenarios.sim_to_real.page import HEADS, headline, table_rows, write_comparison

    check_place(out)
    found = compare(rendered, real, seed)
    write_comparison(found, out)

    def show() -> None:
        for name, side in (("rendered", found.rendered), ("real", found.real)):
            for row in table_rows(name, side)[:1]:
                values = (f"{h} {v}" for h, v in zip(HEADS[1:], row[1:], strict=True))
                click.echo(f"{name}: {', '.join(values)}")
        click.echo(headline(found))
        if found.lacking:
            click.echo(f"{found.lacking}.")
        click.echo(out)

    output.results(found.to_json, show)
