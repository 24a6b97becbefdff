"""The command `view`: look into a recording."""

from __future__ import annotations

from pathlib import Path

import click

from peopleboy.bad_input import BadInput


@click.command()
@click.argument("folder", metavar="RUN", type=click.Path(path_type=Path))
@click.option("--web", is_flag=True, help="Serve it to a browser on this machine, until Ctrl-C.")
@click.option(
    "--port",
    type=click.IntRange(1, 65534),
    metavar="N",
    help="With --web: the page's port; its data takes the next. Any two free ones if not given.",
)
def view(folder: Path, web: bool, port: int | None) -> None:
    """Open the recording of a run in the rerun viewer."""
    from peopleboy.scenarios.recording.recording_file import is_whole, recording_in
    from peopleboy.scenarios.recording.viewer import open_viewer, serve

    if port is not None and not web:
        raise BadInput(f"--port {port}: is where --web serves; give --web too, or neither")
    recording = recording_in(folder)
    if not is_whole(recording):
        click.echo(f"peopleboy: {recording}: was cut off; what it holds is shown", err=True)
    if web:
        serve(recording, lambda address: click.echo(f"{address} shows it; Ctrl-C ends that."), port)
    else:
        open_viewer(recording)
