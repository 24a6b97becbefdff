"""Measure metrics and detection delay of a tracker on one sequence of a data set, as plain data."""

import math
from collections.abc import Iterator
from dataclasses import asdict, replace
from itertools import islice
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.random_streams import stream
from peopleboy.scenarios.files.suite import SuiteRun
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.running.frame_cache import Film, film, frames_of
from peopleboy.scenarios.scores.suite_table import count
from peopleboy.sim.truth.truth import COUNTED_FARTHEST_M, COUNTED_NEAREST_M
from peopleboy.studies.reproductions.experiments.playback import unbroken
from peopleboy.studies.reproductions.tracker_settings import TrackerSetting
from peopleboy.tracker.boxes import add_edge_noise, iou
from peopleboy.tracker.evaluation.area_metrics import PaperMetrics, ThesisMetrics
from peopleboy.tracker.evaluation.box_matching import GATE, associate, counts, pair_up
from peopleboy.tracker.evaluation.evaluate import Counts, evaluate
from peopleboy.tracker.evaluation.sequence import Sums, TrackBoxes, TrueBoxes
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import Track, confirmed
from peopleboy.tracker.trackers import Tracker

Flags = NDArray[np.bool_]

RECORDS: dict[str, type[Sums]] = {"counts": Counts, "thesis": ThesisMetrics, "paper": PaperMetrics}

PATIENCE: Final = 30  # frames after which a person counts as not found
EVERY: Final = 15  # frames between two starts of the tracker
PLAIN: Final = 0.9  # minimum visible fraction of a clearly visible person

USUAL, STRICT, OWN_RANGE, HALF = "usual", "strict", "strict, own range", "half in view"
NEAR, FAR, RANGE = "strict, near aside", "strict, far aside", "strict, near and far aside"
FOUND: Final = "once found"
"""Counting rules for people whom the sources do not count, and for causes of errors.

Usually a box on a person who is not counted is neither correct nor wrong. In strict rules, people who are not
counted or wholly hidden are absent. "own range" also removes tracks that the tracker itself places outside
the counted range. "near aside" ignores boxes on people nearer than the counted range, "far aside" on those
farther away, by the true distance. "half in view" ignores people less than half in view, and boxes on them;
"once found" ignores people until they are first found.
"""
STRETCH: Final = 15  # after this many frames of absence, a person must be found again


def count_sequence(run: SuiteRun, cache: Path) -> Result:
    """Render a run's frames to the cache if necessary, and count as in the thesis's table 3.1."""
    shot = film(run.scenario, run.seed, cache)
    times = [frame.time_s for frame in islice(frames_of(shot, ()), 2)]
    rate_hz = 1.0 / (times[1] - times[0]) if len(times) == 2 else 15.0
    return asdict(count(shot.people(), shot.frames, rate_hz))


def labels_of(shot: Film, run: SuiteRun, label_noise_px: float) -> TrueBoxes:
    """Return the ground truth of a sequence, with noise of this deviation [px] at the edges of its boxes.

    A sequence is labelled once: its noise depends neither on the tracker nor on the repeat.
    """
    truth = shot.truth()
    rng = stream(run.seed, f"labels {run.scenario.name}")
    return replace(truth, box=add_edge_noise(truth.box, label_noise_px, rng))


def score_sequence(
    run: SuiteRun, cache: Path, setting: TrackerSetting, repeat: int, label_noise_px: float = 0.0
) -> Result:
    """Track a sequence with the repeat's random stream, and score it by each counting rule."""
    shot = film(run.scenario, run.seed, cache)
    found, is_in_range = track_sequence(shot, setting.make(stream(repeat, "reproduce.tracker")))
    people, truth = shot.people(), labels_of(shot, run, label_noise_px)
    rows = zip(*(people[name].to_pylist() for name in ("frame", "id", "distance_m")), strict=True)
    known = {(frame, person): distance for frame, person, distance in rows}
    keys = zip(truth.frame.tolist(), truth.id.tolist(), strict=True)
    result: Result = {"frames": shot.frames}
    for way, people_there in truth_by_way(truth, np.array([known[key] for key in keys]), found).items():
        tracks = found.take(is_in_range) if way == OWN_RANGE else found
        scores = evaluate(people_there, tracks, frames=shot.frames)
        result[way] = {record: asdict(getattr(scores, record)) for record in RECORDS}
    return result


def truth_by_way(
    truth: TrueBoxes, distance_m: NDArray[np.float64], found: TrackBoxes
) -> dict[str, TrueBoxes]:
    """Return ground truth for each counting rule: omitted rows are absent, uncounted rows are ignored.

    Args:
        truth: ground truth of a sequence.
        distance_m: (N,) floor distance of each row from the camera.
        found: boxes of a tracker.
    """
    is_target = counts(truth.counted, truth.visible)
    usual = replace(truth, counted=is_target)
    is_near, is_far = distance_m < COUNTED_NEAREST_M, distance_m > COUNTED_FARTHEST_M
    return {
        USUAL: usual,
        STRICT: usual.take(is_target),
        OWN_RANGE: usual.take(is_target),
        NEAR: usual.take(is_target | is_near),
        FAR: usual.take(is_target | is_far),
        RANGE: usual.take(is_target | is_near | is_far),
        HALF: replace(truth, counted=counts(truth.counted, truth.visible, 0.5)),
        FOUND: replace(truth, counted=is_target & ~not_yet_found(usual, found)),
    }


def track_sequence(shot: Film, tracker: Tracker) -> tuple[TrackBoxes, Flags]:
    """Run a tracker on a sequence; tentative tracks do not count.

    Returns:
        Its boxes, and (N,) whether the tracker places them in the range in which the sources count people.
    """
    rows = [
        (number, track.id, box, track.confidence, _is_in_range(track, frame))
        for number, frame in enumerate(frames_of(shot, tracker.cameras), 1)
        for track, box in confirmed(tracker.update(frame), THERMAL)
    ]
    return TrackBoxes.from_rows(row[:4] for row in rows), np.array([row[4] for row in rows], np.bool_)


def _is_in_range(track: Track, frame: Frame) -> bool:
    if track.place is None:
        return True
    x, y, _ = frame.calibrations[THERMAL].position_m
    distance_m = math.hypot(track.place.position_m[0] - x, track.place.position_m[1] - y)
    return COUNTED_NEAREST_M <= distance_m <= COUNTED_FARTHEST_M


def measure_delay(
    run: SuiteRun, cache: Path, setting: TrackerSetting, repeat: int, label_noise_px: float = 0.0
) -> Result:
    """Start a tracker many times in one sequence, each time while a person is clearly visible.

    Returns:
        The number of "starts", and the frames "needed" by each start that found the person, including the
        first frame.
    """
    shot = film(run.scenario, run.seed, cache)
    truth = labels_of(shot, run, label_noise_px)
    starts = set(plain_starts(truth))
    boxes = dict(zip(truth.frame.tolist(), truth.box, strict=True))
    rng = stream(repeat, "reproduce.delay")
    waiting: list[tuple[int, Tracker]] = []
    needed: list[int] = []
    cameras = setting.make(rng).cameras
    for number, frame in enumerate(frames_of(shot, cameras), 1):
        if number in starts:
            waiting.append((number, setting.make(rng)))
        for start, tracker in list(waiting):
            claimed = [box for _, box in confirmed(tracker.update(frame), THERMAL)]
            if claimed and iou(boxes[number][None], np.array(claimed)).max() > GATE:
                needed.append(number - start + 1)
                waiting.remove((start, tracker))
        waiting = [(start, tracker) for start, tracker in waiting if number - start + 1 < PATIENCE]
    return {"starts": len(starts), "needed": needed}


def plain_starts(truth: TrueBoxes) -> Iterator[int]:
    """Yield frames from which exactly one person is present, counted and clearly visible, for long enough."""
    people = np.bincount(truth.frame, minlength=truth.last_frame + 1)
    plain = np.bincount(truth.frame[truth.counted & (truth.visible > PLAIN)], minlength=len(people))
    is_plain = (people == 1) & (plain == 1)
    following = 0
    for start in range(1, len(is_plain) - PATIENCE + 1):
        if start >= following and is_plain[start : start + PATIENCE].all():
            yield start
            following = start + EVERY


def not_yet_found(truth: TrueBoxes, found: TrackBoxes) -> Flags:
    """Return which rows (N,) are of counted people who have appeared and have not yet been found."""
    targets = truth.take(truth.counted)
    pairs = pair_up(targets, found)
    is_hit = np.zeros(len(targets), dtype=np.bool_)
    is_hit[pairs.target[associate(pairs)]] = True
    is_early = np.zeros(len(targets), dtype=np.bool_)
    for person in np.unique(targets.id):
        rows = np.flatnonzero(targets.id == person)
        rows = rows[np.argsort(targets.frame[rows])]
        for stretch in unbroken(targets.frame[rows], STRETCH):
            is_early[rows[stretch]] = np.cumsum(is_hit[rows[stretch]]) == 0
    early = np.zeros(len(truth), dtype=np.bool_)
    early[np.flatnonzero(truth.counted)] = is_early
    return early
