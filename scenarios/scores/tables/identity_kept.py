"""Full occlusions of finished runs, and the identities that were kept through them."""

from collections.abc import Sequence
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import cameras_of, read_run
from peopleboy.scenarios.scores.evaluate_runs import ScoreOptions, read_reference_boxes, reference_of
from peopleboy.scenarios.scores.people_ranges import occluded_in
from peopleboy.sim.world_config import CONTROL_HZ
from peopleboy.tracker.evaluation.occlusion_scores import Occlusion, score_occlusions
from peopleboy.tracker.frame import THERMAL


def occlusions_of(folders: Sequence[Path], options: ScoreOptions) -> list[Occlusion]:
    """Return the identity outcome of every full occlusion in some runs.

    Raises:
        BadInput: a run is not one of a scenario, or its files are unreadable.
    """
    return [occlusion for folder in folders for occlusion in _occlusions_in(folder, options)]


def _occlusions_in(folder: Path, options: ScoreOptions) -> list[Occlusion]:
    about = read_run(folder)
    if not (folder / "truth.parquet").is_file():
        raise BadInput(f"--plots: {folder} has no scenario tables, which state the occlusions; leave it out")
    by = reference_of(folder, about, options)
    every = 1
    if by.camera != THERMAL:
        every = CONTROL_HZ // (cameras_of(folder)[by.camera].rate_hz or CONTROL_HZ)
    truth, tracks = read_reference_boxes(folder, by)
    return score_occlusions(truth, tracks, occluded_in(folder, by.camera, truth, every))
