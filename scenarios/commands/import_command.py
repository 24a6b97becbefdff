"""The command `import-tracks`: tracks made elsewhere, as a run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from peopleboy.scenarios.commands.command_options import FieldsCommand, GivenOptions, options_of, tell_note

if TYPE_CHECKING:
    from peopleboy.scenarios.running.run_options import RunOptions


@click.command("import-tracks", cls=FieldsCommand)
@click.argument("run", metavar="RUN", type=click.Path(path_type=Path))
@click.argument("tracks", metavar="TRACKS", type=click.Path(path_type=Path))
@click.option("--name", required=True, help="What their tracker is called.")
@click.option("--camera", default="thermal", show_default=True, help="Camera in whose images the boxes are.")
@options_of(
    "scenarios.running.run_options:RunOptions",
    *("out", "boxes", "record", "overwrite"),
    out="Folder to leave.  [default: beside RUN, SCENARIO-SEED-NAME, or RUN-NAME for a folder of runs]",
)
def import_tracks(run: Path, tracks: Path, name: str, camera: str, given: GivenOptions[RunOptions]) -> None:
    """Import tracks that another program made of the images of RUN, as a run of their own.

    TRACKS is MOTChallenge text: frame, id, left, top, width, height, confidence, -1, -1, -1; frames are
    the camera's images, counted 1, 2, 3 ... as exports do, and boxes in pixels of them. Leaves a folder with
    RUN's scenario and truth and with these tracks, which report, view, evaluate and export take like any
    other. Status and place on the floor, which such text does not hold, are marked as unknown. The images are
    rendered again, and are those of RUN.

    RUN may be a folder of runs, such as a sweep's. TRACKS is one of files then, SCENARIO-SEED.txt for each
    of them, as benchmarks ask for; those files may lie in a folder data in it.
    """
    from peopleboy.scenarios.finished_runs.import_tracks import TrackImport, imports_by_sequence
    from peopleboy.scenarios.finished_runs.import_tracks import import_tracks as take
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.scenarios.scores.run_scores import headline
    from peopleboy.scenarios.scores.show_scores import print_scores

    out = given.out or run.resolve().parent / f"{_title(run, tracks)}-{name}"
    what = TrackImport(run=run, tracks=tracks, name=name, camera=camera, **{**given.values, "out": out})
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
