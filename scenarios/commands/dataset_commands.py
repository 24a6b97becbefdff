"""Commands that make data sets from runs: `render`, `export`."""

import sys
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from peopleboy.scenarios.commands.command_options import (
    PATH,
    TRACKERS,
    FieldsCommand,
    GivenOptions,
    Output,
    options_of,
    output_options,
    print_note,
    seeds_options,
    workers_options,
)
from peopleboy.scenarios.commands.completion import complete_scenario
from peopleboy.scenarios.export.formats import FORMATS
from peopleboy.wording import counted

if TYPE_CHECKING:
    from peopleboy.scenarios.export.export_runs import ExportOptions
    from peopleboy.scenarios.export.make_dataset import RenderedSet, SetOptions
    from peopleboy.scenarios.run_folder.frame_choice import FrameChoice
    from peopleboy.scenarios.running.engine.task import Workers

FAILED = 1
_CHOICE: Final = "scenarios.run_folder.frame_choice:FrameChoice"
_CHOICE_FIELDS: Final = (
    "every", "frames_per_world", "keep_empty", "least_people", "most_people", "least_height_px",
    "least_visible",
)  # fmt: skip


@click.command(cls=FieldsCommand)
@click.argument("scenarios", metavar="[SCENARIO...]", nargs=-1, shell_complete=complete_scenario)
@options_of(
    "scenarios.export.make_dataset:SetOptions",
    *("frames", "random_worlds", "distribution", "only", "camera_height_m", "pitch_deg", "out", "tracker"),
    tracker=f"Tracker for robots that follow people: {TRACKERS}.  [default: truth]",
)
@options_of(_CHOICE, *_CHOICE_FIELDS, into="choice")
@seeds_options(100)
@workers_options
@output_options
def render(
    scenarios: tuple[str, ...],
    given: "GivenOptions[SetOptions]",
    choice: "GivenOptions[FrameChoice]",
    seeds: range,
    workers: "Workers",
    output: Output,
) -> None:
    """Render a data set with splits, checks and a datasheet.

    The data set contains the given scenarios, with many seeds each. With --random-worlds, it contains one
    random world per seed instead, with its own place, objects, temperatures, people and cameras. With at
    least 7 seeds, every split contains runs.

    With options that choose frames, such as --frames-per-world, the data set contains single images instead
    of whole runs, and takes much less time and space.

    If rendering is interrupted, run the command again to resume it. If you run it again with more --seeds,
    the data set grows, and all earlier runs stay in their splits.
    """
    from peopleboy.scenarios.export.make_dataset import render_set

    options = given.make(scenarios=scenarios, seeds=seeds, choice=choice.make())
    done = render_set(options, workers)
    output.results(done.to_json, lambda: _print_set(done))
    if not done.is_sound:
        sys.exit(FAILED)


def _print_set(done: "RenderedSet") -> None:
    for check in done.checks:
        click.echo(f"{'passed' if not check.failures else 'FAILED'}: {check.what}")
        for failure in check.failures[:5]:
            click.echo(f"        {failure}")
    content = done.statistics["all"].content
    click.echo(
        f"{counted(len(done.runs), 'run')}, {counted(content['frames'], 'frame')}, "
        f"{counted(content['detections'], 'box', 'boxes')} of people, {done.size_mb:.0f} MB"
    )
    if done.lacking:
        click.echo(done.lacking)
    click.echo(done.folder / "README.md")


class FormatName(click.Choice[str]):
    """A format name; formats of other packages are looked up when the command is used."""

    def __init__(self) -> None:
        self.case_sensitive = True

    @cached_property
    def choices(self) -> tuple[str, ...]:  # type: ignore[override]
        """All names."""
        return tuple(FORMATS)


@click.command(cls=FieldsCommand)
@click.argument("runs", nargs=-1, required=True, type=PATH)
@click.option("--format", "form", type=FormatName(), required=True, help="Output format.")
@options_of(
    "scenarios.export.export_runs:ExportOptions",
    *("camera", "least_px", "boxes", "epoch", "ros_distro", "out", "overwrite"),
    out="Output folder.  [default: RUN-FORMAT(-CAMERA) next to the run, or export-FORMAT for several runs]",
)
@options_of(_CHOICE, *_CHOICE_FIELDS, into="choice")
@output_options
def export(
    runs: Sequence[Path],
    form: str,
    given: "GivenOptions[ExportOptions]",
    choice: "GivenOptions[FrameChoice]",
    output: Output,
) -> None:
    """Export runs to the formats of other tools.

    RUNS are run folders, or folders that contain run folders. A rendered data set is exported to `coco`,
    `yolo` and `mot` by split, as listed in its folder `splits`, and `export.json` lists the runs of each
    split.

    `mot` is the MOTChallenge format, which TrackEval reads. `coco` contains masks, boxes and keypoints.
    `images` contains, for each image, the person and body part at every pixel, and true depth. `yolo`
    contains boxes for Ultralytics, and `yolo-pose` adds keypoints. `webdataset` contains tar files, and
    `huggingface` parquet files for the library `datasets`, which it needs (extra `hub`); both with images,
    masks and labels of one camera, and a Croissant file. `minari` and `lerobot` contain saved episodes of
    environments, for the libraries Minari, which it needs (extra `hub`), and LeRobot. `viper` is ViPER XML.
    `mcap` is a ROS 2 bag and needs the package rosbags. `mp4` contains videos and needs the package av.

    `coco`, `images` and `mcap` contain all cameras. Images and masks that the run has not written are
    rendered again, and are bit-identical to those of the run.

    Options that choose frames, such as --every, apply to formats of images, not to those of sequences
    (`minari`, `lerobot`, `mot`, `viper`, `mcap`, `mp4`).
    """
    from peopleboy.scenarios.export.export_runs import export as write
    from peopleboy.scenarios.export.export_runs import notes_on
    from peopleboy.scenarios.export.splits import refuse_unfinished
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.scenarios.run_folder.finished_run import open_whole_runs, runs_in

    for folder in runs:
        refuse_unfinished(folder)
    opened = open_whole_runs(
        [run for folder in runs for run in runs_in(folder)],
        are_named_apart=form != "mot",  # mot names sequences by scenario and seed, for several trackers
        may_be_sampled=True,
    )
    first = opened[0].folder
    what = form if given.camera is None else f"{form}-{given.camera}"
    name = f"{first.name}-{what}" if len(opened) == 1 else f"export-{what}"
    options = given.make(form=form, out=given.out or first.parent / name, choice=choice.make())
    with progress_bar(form, unit="frames") as show:
        write(opened, options, show)
    notes = list(notes_on(opened, options))
    for note in notes:
        print_note(note)
    output.lines({"out": options.out, "format": form, "runs": len(opened), "notes": notes}, options.out)
