"""The command `evaluate`: score tracks against truth."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import BOXES, Number, Output, output_options, tell_note


@click.command()
@click.argument("runs", nargs=-1, type=click.Path(path_type=Path))
@click.option(
    "--truth",
    type=click.Path(path_type=Path),
    help="MOTChallenge truth, such as RUN/truth/gt.txt; or one person's, VOT or OTB.",
)
@click.option(
    "--tracks", type=click.Path(path_type=Path), help="MOTChallenge results, such as RUN/tracks.txt."
)
@click.option(
    "--min-visible",
    type=Number(0.0, 1.0, max_open=True),
    default=0.0,
    show_default=True,
    help="People count if more than this share of them is seen; 0.3 leaves out slivers at the border.",
)
@click.option(
    "--camera",
    help="In whose image boxes are scored.  [default: thermal, or the only one in which there are some]",
)
@click.option(
    "--boxes",
    type=BOXES,
    help="Against which of the truth's boxes: as wide as the torso, or as all of a person.  "
    "[default: what each run was scored by]",
)
@output_options
def evaluate(
    runs: Sequence[Path],
    truth: Path | None,
    tracks: Path | None,
    min_visible: float,
    camera: str | None,
    boxes: str | None,
    output: Output,
) -> None:
    """Score tracks against truth: one pair of files, or the folders of any number of runs.

    A folder that holds folders of runs, such as a suite's, stands for all of them. Several runs of one
    tracker give mean and standard deviation over them, beside the figure of all their frames. Runs of several
    trackers stand side by side, with how each differs from the first over runs of the same scenario and seed.
    Where a tracker says where on the floor people stand, its errors are printed in metres; one that gives no
    boxes is scored on the floor alone. Of runs in which the robot drove among people, it prints how
    comfortable they were.
    """
    from peopleboy.scenarios.run_folder.finished_run import runs_in
    from peopleboy.scenarios.scores.by_tracker import (
        ScoredRun,
        comfort_by_tracker,
        figures_of_all,
        score_by_tracker,
    )
    from peopleboy.scenarios.scores.evaluate_runs import evaluate_files
    from peopleboy.scenarios.scores.show_scores import print_comfort, print_runs
    from peopleboy.tracker.footage.box_kinds import BoxKind

    if camera is not None and not runs:
        raise BadInput("evaluate: --camera goes with folders of runs; give --truth RUN/truth/CAMERA.gt.txt")
    if boxes is not None and not runs:
        raise BadInput(
            "evaluate: --boxes goes with folders of runs; boxes in --truth are of one kind; leave it out"
        )
    if bool(runs) == (truth is not None or tracks is not None):
        raise BadInput("evaluate: give folders of runs, or --truth with --tracks")
    if runs:
        found = [run for folder in runs for run in runs_in(folder)]
        groups = score_by_tracker(found, min_visible, camera, None if boxes is None else BoxKind(boxes))
    elif truth is None or tracks is None:
        raise BadInput("evaluate: --truth and --tracks go together")
    else:
        scores = evaluate_files(truth, tracks, min_visible=min_visible, note=tell_note)
        groups = {str(tracks): [ScoredRun(str(tracks), str(tracks), None, scores)]}
    comfort = comfort_by_tracker(groups)

    def show() -> None:
        print_runs(groups, note=tell_note)
        print_comfort(comfort)

    comforts = {tracker: score.to_json() for tracker, score in comfort.items()}
    output.figures(lambda: figures_of_all(groups) | ({"comfort": comforts} if comforts else {}), show)
