"""Run trackers on recorded frames, cache their tracks, and score them."""

import hashlib
import json
from dataclasses import dataclass
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path

import numpy as np

import benchmarks.peers
from benchmarks.compare import timed_ms
from benchmarks.peers.contestants import BOUNDS, JOINT, PEERS, RATE_HZ, make_contestant
from peopleboy import tracker
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.run_folder.run_files import occluded_shares
from peopleboy.scenarios.running.engine.task import ReportProgress
from peopleboy.scenarios.running.frame_cache import Film, film, frames_of
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.mot_files import read_tracks, write_tracks
from peopleboy.tracker.evaluation.occlusion_scores import OccludedShares, Occlusion, score_occlusions
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes


@dataclass(frozen=True, slots=True, eq=False)
class Result:
    """Result of one tracker on one sequence.

    Attributes:
        name: name of the tracker.
        scenario: name of the scenario.
        scores: all metrics.
        occlusions: identities before and after total occlusions.
        ms: CPU time per frame [ms]: median over seconds of the mean in each, since some frames take longer
            than others, and the first ones compile.
    """

    name: str
    scenario: str
    scores: Scores
    occlusions: tuple[Occlusion, ...]
    ms: float


@dataclass(frozen=True, slots=True)
class SequenceTask:
    """Score several trackers on one sequence."""

    names: tuple[str, ...]
    scenario: str
    seed: int
    folder: Path
    size: int = 1

    @property
    def name(self) -> str:
        """Scenario and seed."""
        return f"{self.scenario}-{self.seed}"

    def __call__(self, report_progress: ReportProgress) -> list[Result]:  # noqa: ARG002
        """Score the trackers one after another."""
        return [compete(name, self.scenario, self.seed, self.folder) for name in self.names]


def compete(name: str, scenario: str, seed: int, folder: Path) -> Result:
    """Score one tracker on one sequence; the sequence and the tracks are cached in the folder.

    Cached tracks are reused as long as the source code of the trackers does not change.
    """
    shot = film(load_scenario(scenario), seed, folder / "films")
    said = folder / "tracks" / f"{name}-{_digest(name)}" / shot.folder.name
    if not said.with_suffix(".json").is_file():
        _run(name, shot, said)
    ms = json.loads(said.with_suffix(".json").read_text(encoding="utf-8"))["ms"]
    truth, tracks = shot.truth(), read_tracks(said.with_suffix(".txt"))
    return Result(
        name=name,
        scenario=scenario,
        scores=evaluate(truth, tracks, frames=shot.frames),
        occlusions=tuple(occlusions_of(shot, truth, tracks)),
        ms=ms,
    )


def occlusions_of(shot: Film, truth: TrueBoxes, tracks: TrackBoxes) -> list[Occlusion]:
    """Score the identities at the total occlusions of a sequence."""
    return score_occlusions(truth, tracks, OccludedShares(occluded_shares(shot.people(), truth), RATE_HZ))


def _run(name: str, shot: Film, said: Path) -> None:
    contestant = make_contestant(name, shot.seed, shot.truth())
    rows, times_ms = [], []
    for number, frame in enumerate(frames_of(shot), 1):
        frame_ms, (boxes, ids) = timed_ms(partial(contestant.step, frame))
        times_ms.append(frame_ms)
        rows += [(number, identity, box, 1.0) for box, identity in zip(boxes, ids, strict=True)]
    said.parent.mkdir(parents=True, exist_ok=True)
    write_tracks(said.with_suffix(".txt"), TrackBoxes.from_rows(rows))
    about = {"ms": _usual(times_ms)}
    said.with_suffix(".json").write_text(json.dumps(about) + "\n", encoding="utf-8")


def _usual(times_ms: list[float]) -> float:
    """Return the median of the means per second."""
    each = round(RATE_HZ)
    return float(
        np.median([np.mean(times_ms[begin : begin + each]) for begin in range(0, len(times_ms), each)])
    )


@cache
def _digest(name: str) -> str:
    """Return a digest of the source code on which a tracker's boxes depend."""
    digest = hashlib.sha256()
    if name in PEERS:
        digest.update(version("trackers").encode())
    packages = [tracker] if name not in PEERS else []
    packages += [benchmarks.peers] if name in (*PEERS, *BOUNDS, JOINT) else []
    for package in packages:
        for path in sorted(Path(package.__path__[0]).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:8]
