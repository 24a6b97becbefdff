"""The command line: `peopleboy`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bad_input import BadInput
from scenarios.show_scores import print_corridor, print_following, print_scores, print_spread

if TYPE_CHECKING:
    from scenarios.run import RunOptions

BAD_INPUT = 2
SEED = "[default: 0, or that of a run's own scenario.yaml]"


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="peopleboy")
def cli() -> None:
    """Scripted people, a robot with thermal and colour cameras, and a tracker that sees only the images."""


@cli.command("list")
def list_command() -> None:
    """List the scenarios of the library, and the suites."""
    from scenarios.load import library
    from scenarios.suite import load_suite, suite_names

    for name, description in library().items():
        click.echo(f"{name:20} {description}")
    for name in suite_names():
        click.echo(f"{name:20} suite: {' '.join(load_suite(name).description.split())}")


@cli.command()
@click.argument("scenario")
@click.option("--seed", type=click.IntRange(min=0), help=f"What is drawn follows from it.  {SEED}")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Picture to write.  [default: SCENARIO-plan.png]"
)
def show(scenario: str, seed: int | None, out: Path | None) -> None:
    """Draw the plan of a scenario, with paths and times."""
    from scenarios.load import load_scenario
    from scenarios.plan import draw_plan

    loaded = load_scenario(scenario)
    path = out if out is not None else Path(f"{loaded.name}-plan.png")
    draw_plan(loaded, loaded.seed if seed is None else seed, path)
    click.echo(path)


@cli.command()
def schema() -> None:
    """Print the JSON schema of scenario files, for editors."""
    import json

    from scenarios.schema import json_schema

    click.echo(json.dumps(json_schema(), indent=2))


@cli.command()
@click.argument("scenario")
@click.option("--seed", type=click.IntRange(min=0), help=f"All that is random follows from it.  {SEED}")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder of the run.  [default: runs/SCENARIO-SEED, and -TRACKER for another tracker]",
)
@click.option("--frames", is_flag=True, help="Write every thermal and colour image as PNG too.")
@click.option("--tracker", default="peopleboy", show_default=True, help="A wrong name lists them all.")
@click.option("--renderer", default="raycast", show_default=True, help="raycast, or bullet (slow reference).")
@click.option("--no-rrd", is_flag=True, help="Write no rerun recording.")
@click.option("--overwrite", is_flag=True, help="Replace an earlier run in the folder.")
def run(
    scenario: str,
    seed: int | None,
    out: Path | None,
    frames: bool,
    tracker: str,
    renderer: str,
    no_rrd: bool,
    overwrite: bool,
) -> None:
    """Run a scenario headless, and leave a folder with truth, tracks, scores and a recording.

    SCENARIO is a name from `peopleboy list` or the path of a YAML file; or a suite, such as dataset1, whose
    runs have seeds of their own and leave no recordings. A suite that was killed goes on where it was.
    """
    from scenarios.load import load_scenario
    from scenarios.progress import run_with_progress
    from scenarios.run import RunOptions
    from scenarios.suite import suite_names
    from tracker.people import DEFAULT_TRACKER

    is_suite = scenario in suite_names()
    if is_suite and seed is not None:
        raise BadInput(f"--seed {seed}: suite {scenario} has seeds of its own; leave it out")
    loaded = None if is_suite else load_scenario(scenario)
    number = seed if seed is not None else 0 if loaded is None else loaded.seed
    name = scenario if loaded is None else f"{loaded.name}-{number}"
    if tracker != DEFAULT_TRACKER:
        name += f"-{tracker}"
    options = RunOptions(
        seed=number,
        out=out if out is not None else Path("runs") / name,
        frames=frames,
        tracker=tracker,
        renderer=renderer,
        record=not no_rrd,
        overwrite=overwrite,
    )
    if loaded is None:
        _run_suite(scenario, options)
        return
    scores = run_with_progress(loaded, options)
    print_scores(scores.people)
    if scores.following is not None:
        print_following(scores.following)
    if scores.corridor is not None:
        print_corridor(scores.corridor)
    for path in sorted(options.out.iterdir()):
        click.echo(path)


def _run_suite(name: str, options: RunOptions) -> None:
    from scenarios.evaluate_runs import evaluate_runs
    from scenarios.run_suite import run_suite

    folders = run_suite(name, options)
    print_spread(evaluate_runs(folders))
    for path in folders:
        click.echo(path)


@cli.command()
@click.argument("suites", nargs=-1)
@click.option(
    "--films",
    type=click.Path(path_type=Path),
    default=Path("runs/films"),
    show_default=True,
    help="Where rendered frames are kept; for a cluster, a folder that all share.",
)
def datasets(suites: Sequence[str], films: Path) -> None:
    """Count what the data sets hold, beside table 3.1 of the thesis; their frames are rendered and kept.

    SUITES are any of dataset1 to dataset4; without a name, all of them.
    """
    from scenarios.show_contents import print_contents
    from scenarios.suite_table import THESIS

    for name in suites:
        if name not in THESIS:
            raise BadInput(f"datasets: unknown data set {name!r}; there are {', '.join(THESIS)}")
    print_contents(suites or tuple(THESIS), films)


@cli.command()
@click.argument("runs", nargs=-1, type=click.Path(path_type=Path))
@click.option(
    "--truth", type=click.Path(path_type=Path), help="MOTChallenge truth, such as RUN/truth/gt.txt."
)
@click.option(
    "--tracks", type=click.Path(path_type=Path), help="MOTChallenge results, such as RUN/tracks.txt."
)
@click.option(
    "--min-visible",
    type=click.FloatRange(0.0, 1.0, max_open=True),
    default=0.0,
    show_default=True,
    help="People count if more than this share of them is seen; 0.3 leaves out slivers at the border.",
)
def evaluate(runs: Sequence[Path], truth: Path | None, tracks: Path | None, min_visible: float) -> None:
    """Score tracks against truth: one pair of files, or the folders of any number of runs.

    A folder that holds folders of runs, such as a suite's, stands for all of them. Several runs give mean and
    standard deviation over them, beside the figure of all their frames.
    """
    from scenarios.evaluate_runs import evaluate_files, evaluate_runs, runs_in

    if bool(runs) == (truth is not None or tracks is not None):
        raise BadInput("evaluate: give folders of runs, or --truth with --tracks")
    if runs:
        print_spread(evaluate_runs([run for folder in runs for run in runs_in(folder)], min_visible))
    elif truth is None or tracks is None:
        raise BadInput("evaluate: --truth and --tracks go together")
    else:
        print_scores(evaluate_files(truth, tracks, min_visible=min_visible))


@cli.command()
@click.argument("scenario")
@click.option(
    "--seeds", type=click.IntRange(min=1), default=10, show_default=True, help="How many, from 0 on."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs"),
    show_default=True,
    help="Where the runs' folders go.",
)
@click.option("--tracker", default="peopleboy", show_default=True, help="A wrong name lists them all.")
@click.option(
    "--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Runs at the same time."
)
@click.option("--overwrite", is_flag=True, help="Replace earlier runs.")
def sweep(scenario: str, seeds: int, out: Path, tracker: str, jobs: int, overwrite: bool) -> None:
    """Run a scenario with many seeds, without recordings, and score them together."""
    from scenarios.evaluate_runs import evaluate_runs
    from scenarios.sweep import run_seeds

    folders = run_seeds(scenario, range(seeds), out, tracker, jobs, overwrite=overwrite)
    print_spread(evaluate_runs(folders))


@cli.command()
@click.option(
    "--controllers",
    default="follow_person,follow_person@truth",
    show_default=True,
    help="Behaviours, each with @ and a tracker if it is to see by another one, or by the truth.",
)
@click.option(
    "--scenario",
    "scenarios",
    multiple=True,
    default=("single_follow",),
    show_default=True,
    help="Name or file; can be given again.",
)
@click.option(
    "--seeds", type=click.IntRange(min=1), default=20, show_default=True, help="How many, from 0 on."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs") / "compare",
    show_default=True,
    help="Where runs, tables and plots go; earlier ones are replaced.",
)
@click.option(
    "--jobs", type=click.IntRange(min=1), default=2, show_default=True, help="Runs at the same time."
)
def compare(controllers: str, scenarios: Sequence[str], seeds: int, out: Path, jobs: int) -> None:
    """Let controllers drive through the same scenes, and print how they did, with confidence intervals."""
    from scenarios.compare import compare, parse_controller
    from scenarios.load import load_scenario
    from scenarios.show_comparison import show_comparison

    chosen = [parse_controller(text) for text in controllers.split(",")]
    names = [load_scenario(scenario).name for scenario in scenarios]
    for scenario, name in zip(scenarios, names, strict=True):
        runs = compare(scenario, chosen, range(seeds), out / name, jobs)
        show_comparison(name, runs, out / name)
        click.echo(out / name / "comparison.png")


@cli.command("train-occlusion")
@click.option("--tracker", default="peopleboy", show_default=True, help="Whom to teach: peopleboy or thesis.")
@click.option(
    "--seeds",
    type=click.IntRange(min=1),
    default=5,
    show_default=True,
    help="Runs of each scenario.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder for the examples and the learned table.  [default: runs/occlusion-TRACKER]",
)
@click.option("--again", is_flag=True, help="Run the scenarios even if the examples are there.")
@click.option("--triplets/--no-triplets", default=True, help="Try weighted triplets as well (a minute).")
@click.option("--ship", is_flag=True, help="Put the learned table in the place of the tracker's own.")
def train_occlusion(
    tracker: str, seeds: int, out: Path | None, again: bool, triplets: bool, ship: bool
) -> None:
    """Learn from scenarios which of two overlapping people is in front, and compare with the thesis.

    One set of scenarios is learned from, another one is for testing. Needs scikit-learn: peopleboy[train].
    """
    from scenarios.occlusion_lesson import give_lesson

    folder = out if out is not None else Path("runs") / f"occlusion-{tracker}"
    click.echo(give_lesson(folder, tracker, seeds, triplets=triplets, again=again, ship=ship))


@cli.command()
@click.argument("names", metavar="[ID]...", nargs=-1)
@click.option("--quick", is_flag=True, help="A little of everything, in minutes.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder of the page and the results.  [default: runs/reproduce, or runs/reproduce-quick]",
)
@click.option(
    "--films",
    type=click.Path(path_type=Path),
    default=Path("runs") / "films",
    show_default=True,
    help="Where rendered frames are kept; for a cluster, a folder that all share.",
)
@click.option("--jobs", type=click.IntRange(min=1), help="Processes at the same time.  [default: one a core]")
@click.option("--scheduler", metavar="tcp://...", help="Work on the cluster of this Dask scheduler.")
@click.option("--list", "lists", is_flag=True, help="List tables and figures, and do nothing.")
def reproduce(
    names: Sequence[str],
    quick: bool,
    out: Path | None,
    films: Path,
    jobs: int | None,
    scheduler: str | None,
    lists: bool,
) -> None:
    """Measure every table and figure of the sources again, and write one page about it.

    ID is one of `--list`, or its number: 4.9 stands for figures 4.9a and 4.9b. A killed call goes on where it
    was when it is given again.
    """
    from scenarios.reproduce.show import list_experiments, reproduce_with_progress

    if lists:
        list_experiments(names)
    else:
        folder = out if out is not None else Path("runs") / ("reproduce-quick" if quick else "reproduce")
        click.echo(reproduce_with_progress(names, folder, films, jobs, scheduler, quick=quick))


@cli.command()
@click.argument("folder", metavar="RUN", type=click.Path(path_type=Path))
def view(folder: Path) -> None:
    """Open the recording of a run in the rerun viewer."""
    from scenarios.record import open_viewer

    open_viewer(folder / "recording.rrd")


def main(arguments: Sequence[str] | None = None) -> Any:
    """Run the command line; a user's mistake is one line on standard error and exit code 2."""
    try:
        code = cli.main(args=arguments, prog_name="peopleboy", standalone_mode=False)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        code = BAD_INPUT
    except click.ClickException as error:
        code = _complain(error.format_message())
    except click.Abort:
        code = 130
    except BadInput as error:
        code = _complain(str(error))
    sys.exit(code if isinstance(code, int) else 0)


def _complain(message: str) -> int:
    click.echo(f"peopleboy: {' '.join(message.split())}", err=True)
    return BAD_INPUT
