"""The command `import-tracks`: tracks made elsewhere, as a run."""

from __future__ import annotations

from pathlib import Path

import click

from peopleboy.scenarios.commands.options import boxes_option, tell_note


@click.command("import-tracks")
@click.argument("run", metavar="RUN", type=click.Path(path_type=Path))
@click.argument("tracks", metavar="TRACKS", type=click.Path(path_type=Path))
@click.option("--name", required=True, help="What their tracker is called.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder to leave.  [default: beside RUN, SCENARIO-SEED-NAME, or RUN-NAME for a folder of runs]",
)
@click.option("--camera", default="thermal", show_default=True, help="In whose images the boxes are.")
@boxes_option
@click.option("--no-rrd", is_flag=True, help="Write no rerun recording.")
@click.option("--overwrite", is_flag=True, help="Replace an earlier run in the folder.")
def import_tracks(
    run: Path,
    tracks: Path,
    name: str,
    out: Path | None,
    camera: str,
    boxes: str,
    no_rrd: bool,
    overwrite: bool,
) -> None:
    """Take tracks that were made elsewhere, of the images of RUN, for those of a run.

    TRACKS is MOTChallenge text: frame, id, left, top, width, height, confidence, -1, -1, -1; frames are
    the camera's images, counted 1, 2, 3 ... as exports do, and boxes in pixels of them. Leaves a folder with
    RUN's scenario and truth and with these tracks, which report, view, evaluate and export take like any
    other. What such text does not tell, status and place on the floor, is said to be unknown. The images are
    rendered again, and are those of RUN.

    RUN may be a folder of runs, such as a sweep's. TRACKS is one of files then, SCENARIO-SEED.txt for each
    of them, as benchmarks ask for; those files may lie in a folder data in it.
    """
    from peopleboy.scenarios.finished_runs.import_tracks import TrackImport, imports_by_sequence
    from peopleboy.scenarios.finished_runs.import_tracks import import_tracks as take
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.scenarios.scores.run_scores import headline
    from peopleboy.scenarios.scores.show_scores import print_scores
    from peopleboy.tracker.footage.box_kinds import BoxKind

    what = TrackImport(
        run=run,
        tracks=tracks,
        name=name,
        out=out if out is not None else run.resolve().parent / f"{_title(run, tracks)}-{name}",
        camera=camera,
        boxes=BoxKind(boxes),
        record=not no_rrd,
        overwrite=overwrite,
    )
    each = imports_by_sequence(what) if tracks.is_dir() else [what]
    for adoption in each:
        with progress_bar(adoption.out.name, unit="frames") as show:
            scores = take(adoption, show)
        if len(each) == 1:
            print_scores(scores.people)
        click.echo(f"{adoption.tracks.stem}: {headline(scores)}")
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
