"""Commands that look into a run: `view` its recording, `scene-model` runs the scene model over its images."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.options import FieldsCommand, GivenOptions, WholeNumber, options_of

if TYPE_CHECKING:
    from peopleboy.scenarios.running.run_options import RunOptions


@click.command()
@click.argument("folder", metavar="RUN", type=click.Path(path_type=Path))
@click.option("--web", is_flag=True, help="Serve it to a browser on this machine, until Ctrl-C.")
@click.option(
    "--port",
    type=WholeNumber(1, 65534),
    metavar="N",
    help="With --web: the page's port; its data takes the next. Any two free ones if not given.",
)
def view(folder: Path, web: bool, port: int | None) -> None:
    """Open the recording of a run in the rerun viewer."""
    from peopleboy.scenarios.recording.recording_file import is_whole, layers_in, recording_in
    from peopleboy.scenarios.recording.viewer import open_viewer, serve

    if port is not None and not web:
        raise BadInput(f"--port {port}: is where --web serves; give --web too, or neither")
    recording = recording_in(folder)
    if not is_whole(recording):
        click.echo(f"peopleboy: {recording}: was cut off; what it holds is shown", err=True)
    layers = [recording, *layers_in(folder)]
    if web:
        serve(layers, lambda address: click.echo(f"{address} shows it; Ctrl-C ends that."), port)
    else:
        open_viewer(layers)


@click.command("scene-model", cls=FieldsCommand)
@click.argument("folder", metavar="RUN", type=click.Path(path_type=Path))
@options_of(
    "scenarios.running.run_options:RunOptions", "out", "record", out="Folder to leave.  [default: RUN/scene]"
)
@click.option("--no-heat", is_flag=True, help="Find people by their shape alone, without the thermal image.")
def scene_model(folder: Path, no_heat: bool, given: GivenOptions[RunOptions]) -> None:
    """Find what was moved in a run, and which person moved it, in the depth images of its robot.

    The run needs images: run the scenario with --frames, and a camera `depth`. Leaves scene.jsonl, a line a
    frame; static_map.ply, what stands, as points; background.png, its depth in the last view; and scene.rrd,
    which `view` shows over the run's recording.
    """
    from peopleboy.scenarios.finished_runs.run_scene_model import FOLDER, SceneModelOptions, run_scene_model
    from peopleboy.scenarios.progress_bar import progress_bar
    from peopleboy.scenarios.run_folder.atomic_output import check_named, writing_to
    from peopleboy.scenarios.run_folder.finished_run import open_run

    run = open_run(folder)
    place = given.out or folder / FOLDER
    check_named(place)
    if place.exists() and not (place / "scene.jsonl").is_file():
        raise BadInput(f"{place}: is no folder of this command and will not be replaced; give another --out")
    options = SceneModelOptions(has_heat=not no_heat, record=given.record is None)
    with writing_to(place), progress_bar(folder.name, unit="frames") as show:
        lines = run_scene_model(run, place, options, show)
    for line in lines or ["Nothing was moved."]:
        click.echo(line)
    click.echo(place)
