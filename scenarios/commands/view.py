"""The command `view`: look into a recording."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("folder", metavar="RUN", type=click.Path(path_type=Path))
@click.option("--web", is_flag=True, help="Serve it to a browser on this machine, until Ctrl-C.")
def view(folder: Path, web: bool) -> None:
    """Open the recording of a run in the rerun viewer."""
    from peopleboy.scenarios.recording.viewer import is_whole, open_viewer, recording_in, serve

    recording = recording_in(folder)
    if not is_whole(recording):
        click.echo(f"peopleboy: {recording}: was cut off; what it holds is shown", err=True)
    if web:
        serve(recording, lambda address: click.echo(f"{address} shows it; Ctrl-C ends that."))
    else:
        open_viewer(recording)
