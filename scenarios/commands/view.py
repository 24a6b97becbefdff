"""The command `view`: look into a recording."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("folder", metavar="RUN", type=click.Path(path_type=Path))
def view(folder: Path) -> None:
    """Open the recording of a run in the rerun viewer."""
    from scenarios.record import open_viewer

    open_viewer(folder / "recording.rrd")
