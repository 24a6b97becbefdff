"""Commands that make data sets of runs: `render`, `export`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import (
    BOXES,
    TRACKERS,
    Number,
    WholeNumber,
    complete_trackers,
    tell_note,
    workers_options,
)
from peopleboy.scenarios.commands.completion import complete_scenario
from peopleboy.scenarios.export.formats import FORMATS
from peopleboy.wording import counted

FAILED = 1


@click.command()
@click.argument("scenarios", metavar="[SCENARIO...]", nargs=-1, shell_complete=complete_scenario)
@click.option("--frames", is_flag=True, help="Write every image too, as for `run`; else truth alone.")
@click.option(
    "--seeds",
    type=WholeNumber(min=1),
    help="How many, from 0 on; from 7 on every split has runs.  [default: 100]",
)
@click.option(
    "--randomise",
    metavar="N",
    type=WholeNumber(min=1),
    help="In place of scenarios: how many worlds, each drawn at random.",
)
@click.option(
    "--seed",
    type=WholeNumber(min=0),
    help="Of the first random world; the next one has the next.  [default: 0]",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder of the set.  [default: sets/SCENARIO-SCENARIO..., or sets/worlds]",
)
@click.option(
    "--tracker",
    shell_complete=complete_trackers,
    default="truth",
    show_default=True,
    help=f"Whose eyes steer robots that follow people: {TRACKERS}.",
)
@workers_options
def render(
    scenarios: Sequence[str],
    frames: bool,
    seeds: int | None,
    randomise: int | None,
    seed: int | None,
    out: Path | None,
    tracker: str,
    workers: int | None,
    scheduler: str | None,
) -> None:
    """Render a data set: scenarios with many seeds, split, counted and checked, with a datasheet.

    Or, with --randomise, worlds of which each has its own place, things, temperatures, people and cameras. A
    killed call goes on where it was; with more --seeds, or worlds, the set grows, and no run changes its
    split.
    """
    from peopleboy.scenarios.export.make_dataset import of_scenarios, of_worlds, render_set
    from peopleboy.scenarios.running.engine.task import chosen_workers

    who = chosen_workers(workers, scheduler)
    if randomise is None:
        if seed is not None or not scenarios:
            raise BadInput("render: give scenarios, or --randomise N, which --seed goes with")
        contents = of_scenarios(scenarios, 100 if seeds is None else seeds)
        usual = "-".join(contents.about["scenarios"])
    else:
        if seeds is not None or scenarios:
            raise BadInput(
                "render: --randomise draws worlds in place of scenarios and --seeds; leave these out"
            )
        contents, usual = of_worlds(randomise, 0 if seed is None else seed), "worlds"
    folder = out if out is not None else Path("sets") / usual
    done = render_set(contents, folder, frames=frames, tracker=tracker, workers=who)
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


@click.command()
@click.argument("runs", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--format", "form", type=FormatName(), required=True, help="What to write.")
@click.option(
    "--camera",
    metavar="NAME",
    help="Whose images and boxes mot, yolo, viper or mp4 tell.  [default: thermal; mp4: thermal and colour]",
)
@click.option(
    "--least-px",
    type=Number(0.0),
    help="How wide and high boxes of yolo and yolo-pose are at least, in pixels; 0 for all.  [default: 3]",
)
@click.option(
    "--boxes",
    type=BOXES,
    help="What boxes of mot's truth are drawn round: the torso, or all of a person.  [default: torso]",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder to leave.  [default: beside the run, RUN-FORMAT(-CAMERA); of several, export-FORMAT]",
)
@click.option("--overwrite", is_flag=True, help="Replace an earlier export in the folder.")
def export(
    runs: Sequence[Path],
    form: str,
    camera: str | None,
    least_px: float | None,
    boxes: str | None,
    out: Path | None,
    overwrite: bool,
) -> None:
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
    from peopleboy.tracker.footage.box_kinds import BoxKind

    for folder in runs:
        refuse_unfinished(folder)
    opened = open_whole_runs(
        [run for folder in runs for run in runs_in(folder)],
        are_named_apart=form != "mot",  # which names sequences by scenario and seed, for several trackers
    )
    first = opened[0].folder
    what = form if camera is None else f"{form}-{camera}"
    name = f"{first.name}-{what}" if len(opened) == 1 else f"export-{what}"
    folder = out if out is not None else first.parent / name
    kind = None if boxes is None else BoxKind(boxes)
    frames = sum(run.frames for run in opened)
    with progress_bar(form, unit="frames") as show:
        play = counted(lambda frame: show(frame, frames))
        write(opened, form, folder, play, camera=camera, least_px=least_px, boxes=kind, overwrite=overwrite)
    for note in notes_on(opened, form, camera, kind):
        tell_note(note)
    click.echo(folder)
