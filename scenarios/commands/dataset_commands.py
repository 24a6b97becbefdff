"""Commands that make data sets of runs: `render`, `export`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import click

from peopleboy.scenarios.commands.command_options import (
    PATH,
    TRACKERS,
    FieldsCommand,
    GivenOptions,
    options_of,
    tell_note,
    workers_options,
)
from peopleboy.scenarios.commands.completion import complete_scenario
from peopleboy.scenarios.export.formats import FORMATS
from peopleboy.wording import counted

if TYPE_CHECKING:
    from peopleboy.scenarios.export.export_runs import ExportOptions
    from peopleboy.scenarios.export.make_dataset import SetOptions
    from peopleboy.scenarios.running.engine.task import Workers

FAILED = 1


@click.command(cls=FieldsCommand)
@click.argument("scenarios", metavar="[SCENARIO...]", nargs=-1, shell_complete=complete_scenario)
@options_of(
    "scenarios.export.make_dataset:SetOptions",
    *("frames", "seeds", "randomise", "seed", "out", "tracker"),
    tracker=f"Tracker that steers robots that follow people: {TRACKERS}.  [default: truth]",
)
@workers_options
def render(scenarios: tuple[str, ...], given: GivenOptions[SetOptions], workers: Workers) -> None:
    """Render a data set: scenarios with many seeds, split, counted and checked, with a datasheet.

    Or, with --randomise, worlds of which each has its own place, things, temperatures, people and cameras. A
    killed call goes on where it was; with more --seeds, or worlds, the set grows, and no run changes its
    split.
    """
    from peopleboy.scenarios.export.make_dataset import render_set

    options = given.make(scenarios=scenarios)
    contents, name = options.contents()
    folder = options.out or Path("sets") / name
    done = render_set(contents, folder, frames=options.frames, tracker=options.tracker, workers=workers)
    for check in done.checks:
        click.echo(f"{'holds' if not check.failures else 'FAILS'}: {check.what}")
        for failure in check.failures[:5]:
            click.echo(f"       {failure}")
    content = done.statistics["all"].content
    click.echo(
        f"{counted(len(done.runs), 'run')}, {counted(content['frames'], 'frame')}, "
        f"{counted(content['detections'], 'box', 'boxes')} of people, {done.size_mb:.0f} MB"
    )
    if done.lacking:
        click.echo(done.lacking)
    click.echo(folder / "README.md")
    if not done.is_sound:
        sys.exit(FAILED)


class FormatName(click.Choice[str]):
    """A format's name, of another package's too; these are looked for only when the command is used."""

    def __init__(self) -> None:
        self.case_sensitive = True

    @cached_property
    def choices(self) -> tuple[str, ...]:  # type: ignore[override]
        """All names."""
        return tuple(FORMATS)


@click.command(cls=FieldsCommand)
@click.argument("runs", nargs=-1, required=True, type=PATH)
@click.option("--format", "form", type=FormatName(), required=True, help="What to write.")
@options_of(
    "scenarios.export.export_runs:ExportOptions",
    *("camera", "least_px", "boxes", "epoch", "ros_distro", "out", "overwrite"),
    out="Folder to leave.  [default: beside the run, RUN-FORMAT(-CAMERA); of several, export-FORMAT]",
)
def export(runs: Sequence[Path], form: str, given: GivenOptions[ExportOptions]) -> None:
    """Hand runs over to other tools; a folder that holds folders of runs stands for all of them.

    Runs of a rendered set go to coco, yolo and mot split by split, as its folder `splits` says; export.json
    names the runs of each.

    mot: MOTChallenge, for TrackEval. coco: masks, boxes, keypoints. images: beside every image, who is at
    each pixel, which part of the body, and true depth. yolo, yolo-pose: boxes, and keypoints, for
    Ultralytics. viper: ViPER XML. mcap: ROS 2 bags. mp4: films. coco, images and mcap tell of every camera.
    Images and masks are rendered again, and are those of the run. mcap needs the package rosbags, mp4 av.
    """
    from peopleboy.scenarios.export.export_runs import export as write
    from peopleboy.scenarios.export.export_runs import notes_on
    from peopleboy.scenarios.export.replay import counted
    from peopleboy.scenarios.export.splits import refuse_unfinished
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.scenarios.run_folder.finished_run import open_whole_runs, runs_in

    for folder in runs:
        refuse_unfinished(folder)
    opened = open_whole_runs(
        [run for folder in runs for run in runs_in(folder)],
        are_named_apart=form != "mot",  # which names sequences by scenario and seed, for several trackers
    )
    first = opened[0].folder
    what = form if given.camera is None else f"{form}-{given.camera}"
    name = f"{first.name}-{what}" if len(opened) == 1 else f"export-{what}"
    options = given.make(form=form, out=given.out or first.parent / name)
    frames = sum(run.frames for run in opened)
    with progress_bar(form, unit="frames") as show:
        write(opened, options, counted(lambda frame: show(frame, frames)))
    for note in notes_on(opened, options):
        tell_note(note)
    click.echo(options.out)
