"""Tracking quality of the panoramic trackers on the floor: `python -m benchmarks.all_round`.

Tuning and training used seeds from 100 on; these results use seeds from 0 on.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import islice
from statistics import median
from typing import Final

import click
import cv2
import numpy as np

from benchmarks import call
from benchmarks.compare import compare, percents, print_table, spent_ms, timed_ms
from benchmarks.peers.detectors import Hog
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.scenarios.running.engine.task import ReportProgress, chosen_workers
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.geometry.panorama import MIRRORS, Mirror, Panorama
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from peopleboy.tracker.evaluation.evaluate import Scores, combine, evaluate
from peopleboy.tracker.evaluation.floor import Places
from peopleboy.tracker.frame import COLOUR, PANORAMA, THERMAL, Frame
from peopleboy.tracker.sensors.panorama.panorama_sensor import PanoramaSensor
from peopleboy.tracker.track import Status, Track
from peopleboy.tracker.trackers import Tracker, make_tracker
from peopleboy.tracker.tracking.config import PANORAMIC
from peopleboy.tracker.tracking.people_tracker import PeopleTracker

NEAREST_M: Final = 1.2
FARTHEST_M: Final = 6.0
ONE_IMAGE: Final = "one image"
"""The tracker `panoramic` without motion constraints: only the newest image determines positions."""

OTHER_CAMERAS: Final = {
    "narrow mirror": Panorama(mirror=MIRRORS["narrow"]),
    "tall mirror at 1.3 m": Panorama(
        mirror=Mirror(
            half_apex_rad=math.radians(65.0), lens_half_angle_rad=math.radians(52.0), lens_m=0.05, apex_m=1.3
        )
    ),
}
"""Cameras other than the default: 35 to 8 degrees below the horizon, and 40 below to 12 above."""

_RESTLESS: Final = 32.0  # acceleration [m/s2] that leaves nothing of the prediction
ROUND: Final = "panoramic_round"
FOLLOWED: Final = "anna"

TIMED: Final = (
    ("room_long", "panoramic-paper"),
    ("panoramic_crossing", "panoramic"),
    ("panoramic_moving", "panoramic"),
)
"""Cases timed against HOG: the paper's tracker, and `panoramic` on a standing and on a driving robot."""
_TIMED_FRAMES: Final = 600
COLUMNS: Final = (
    *("scenario", "tracker", "distance [m]", "position [m]"),
    *("found %", "IDF1 %", "in ellipse %", "NEES", "ms"),
)
_HOG_EVERY: Final = 15
_HOG_MS: Final = 80.0
"""Time of HOG to which times are scaled, for comparisons between machines [ms]."""


@dataclass(slots=True)
class _Rows:
    """Ground truth and tracks over the frames of a run that have a new panorama."""

    truth: list[tuple[float, ...]] = field(default_factory=list)
    tracks: list[tuple[float, ...]] = field(default_factory=list)

    def add(self, frame: int, tick: Tick) -> None:
        robot = tick.truth.robot
        for person in tick.truths[PANORAMA].people:
            x, y = robot.to_local(person.position_m)
            counts = NEAREST_M <= math.hypot(x, y) <= FARTHEST_M
            inside = person.inside_fraction
            seen = min(person.visible_fraction / inside, 1.0) if inside > 0 else 0.0
            self.truth.append((frame, person.id, x, y, counts, seen))
        for track in tick.tracks:
            if track.place is not None and track.status is not Status.TENTATIVE:
                place = track.place
                self.tracks.append((frame, track.id, *place.position_m, *place.covariance_m2))

    def scores(self, frames: int) -> Scores:
        true, found = (
            np.array(rows).reshape(-1, width) for rows, width in ((self.truth, 6), (self.tracks, 7))
        )
        (frame, person), (seen, track) = (rows[:, :2].astype(np.int64).T for rows in (true, found))
        standing = Places(frame=frame, id=person, position_m=true[:, 2:4])
        believed = Places(frame=seen, id=track, position_m=found[:, 2:4], covariance_m2=found[:, 4:])
        targets = standing.as_targets(true[:, 4] > 0, true[:, 5])
        candidates = believed.as_candidates(np.ones(len(found)))
        return evaluate(targets, candidates, frames=frames, standing=standing, believed=believed)


@dataclass(frozen=True, slots=True)
class Played:
    """Results of one run.

    Attributes:
        scores: metrics on the floor.
        distance_m: mean absolute distance error of matched people [m], and their number.
        update_ms: median time of the tracker's updates with a new panorama [ms].
        handed_over: per entry of the person of `ROUND` into the thermal image, seconds until the track has a
            box there; NaN if the person leaves before.
        numbers: ids of the person's tracks.
    """

    scores: Scores
    distance_m: tuple[float, int]
    update_ms: float
    handed_over: tuple[float, ...] = ()
    numbers: frozenset[int] = frozenset()


@dataclass(frozen=True, slots=True)
class Play:
    """A run as a task."""

    scenario: str
    tracker: str
    seed: int
    camera: str = ""
    size: int = 1

    @property
    def name(self) -> str:
        """Name of the run."""
        return " ".join(filter(None, (self.scenario, self.tracker, self.camera, str(self.seed))))

    def __call__(self, report_progress: ReportProgress) -> Played:  # noqa: ARG002
        """Execute the run."""
        tracker = _Timed(_make(self.tracker, self.seed))
        scenario = load_scenario(self.scenario).mounting(tracker.cameras)
        config = _with_camera(scenario.world(self.seed), self.camera)
        rows, count, watch = _Rows(), 0, _Watch()
        with SimulatedWorld(config) as world:
            frames = round(scenario.duration_s * config.control_hz)
            for tick in closed_loop(world, tracker, scenario.make_behaviour(), frames):
                watch.add(tick)
                if PANORAMA in tick.truths:
                    count += 1
                    rows.add(count, tick)
        scores = rows.scores(count)
        return Played(
            scores,
            _distance_error(rows),
            median(tracker.spent_ms),
            tuple(watch.times_s(watch.has_box)),
            watch.numbers,
        )


def _with_camera(config: WorldConfig, name: str) -> WorldConfig:
    """Replace the panoramic camera by another one, if there is a name."""
    if not name:
        return config
    cameras = dict(config.robot.cameras)
    cameras[PANORAMA] = replace(cameras[PANORAMA], camera=OTHER_CAMERAS[name])
    return replace(config, robot=replace(config.robot, cameras=cameras))


def _make(name: str, seed: int) -> Tracker:
    if name == ONE_IMAGE:
        motion = replace(PANORAMIC.motion, acceleration_m_s2=(_RESTLESS, 0.2, _RESTLESS))
        config = replace(PANORAMIC, motion=motion)
        return PeopleTracker((PanoramaSensor(tracker=config),), config)
    return make_tracker(name, seed)


class _Timed:
    """Wrapper that times a tracker's updates with a new panorama."""

    def __init__(self, tracker: Tracker) -> None:
        self._tracker = tracker
        self.cameras = tracker.cameras
        self.spent_ms: list[float] = []

    def update(self, frame: Frame) -> tuple[Track, ...]:
        if PANORAMA not in frame.images:
            return self._tracker.update(frame)
        frame.rgb(PANORAMA)  # render lazy images before timing
        update_ms, tracks = timed_ms(partial(self._tracker.update, frame))
        self.spent_ms.append(update_ms)
        return tracks


@dataclass(slots=True)
class _Watch:
    """When a person is in the thermal image, and the ids of the person's tracks."""

    seen: list[tuple[float, bool]] = field(default_factory=list)
    has_box: list[bool] = field(default_factory=list)
    numbers: frozenset[int] = frozenset()
    newest: int = 0

    def add(self, tick: Tick) -> None:
        person = next((one for one in tick.truth.people if one.name == FOLLOWED), None)
        if person is None:
            return
        track = _track_of(tick, person, self.newest)
        if track is not None:
            self.newest = track.id
            self.numbers |= {track.id}
        self.seen.append((tick.truth.time_s, person.visible_fraction >= 0.5))
        self.has_box.append(track is not None and THERMAL in track.boxes)

    def times_s(self, has: Sequence[bool]) -> Iterator[float]:
        """Yield, per entry of the person into the image, the time until `has` is true [s]; NaN if never."""
        came_s = None
        for k, (time_s, is_in) in enumerate(self.seen):
            if is_in and came_s is None and k > 0 and not self.seen[k - 1][1]:
                came_s = time_s
            if came_s is not None and has[k]:
                yield time_s - came_s
                came_s = None
            elif came_s is not None and not is_in:
                yield math.nan
                came_s = None


def _track_of(tick: Tick, person: PersonTruth, before: int) -> Track | None:
    """Return the track of a person: the previous one, or the nearest, if within half a metre."""
    place = tick.truth.robot.to_local(person.position_m)
    near = {
        (track.id != before, math.dist(track.place.position_m, place)): track
        for track in tick.tracks
        if track.place is not None and math.dist(track.place.position_m, place) < 0.5
    }
    return near[min(near)] if near else None


def _distance_error(rows: _Rows) -> tuple[float, int]:
    """Return the mean distance error of people with a track within half a metre, and their number."""
    tracks: dict[float, list[tuple[float, float]]] = {}
    for frame, _, x, y, *_ in rows.tracks:
        tracks.setdefault(frame, []).append((x, y))
    errors = []
    for frame, _, x, y, counts, _ in rows.truth:
        away = [(math.dist(place, (x, y)), place) for place in tracks.get(frame, ())] if counts else []
        if away and min(away)[0] < 0.5:
            errors.append(abs(math.hypot(*min(away)[1]) - math.hypot(x, y)))
    return float(np.mean(errors)) if errors else math.nan, len(errors)


@click.command()
@click.argument("scenarios", nargs=-1)
@click.option("--seeds", type=click.IntRange(min=1), default=10, show_default=True)
@click.option("--laps", type=click.IntRange(min=1), default=50, show_default=True, help=f"Runs of {ROUND}.")
@click.option(
    "--first-seed", "first", type=click.IntRange(min=0), default=0, show_default=True, help="First seed."
)
@click.option("--workers", type=click.IntRange(min=1), help="Processes.")
def main(scenarios: tuple[str, ...], seeds: int, laps: int, first: int, workers: int | None) -> None:
    """Print metrics on the floor, and the times of handover to the thermal image.

    SCENARIOS are the scenarios to run; the default is all.
    """
    plan = [
        ("room_long", "panoramic-paper", 1, ""),
        ("room_long", ONE_IMAGE, seeds, ""),
        ("room_long", "panoramic", seeds, ""),
        ("panoramic_crossing", "panoramic", seeds, ""),
        ("panoramic_moving", "panoramic", seeds, ""),
        (ROUND, "handover", laps, ""),
    ]
    moved = ("panoramic_crossing", "panoramic_moving")
    plan += [(scenario, "panoramic", seeds, camera) for scenario in moved for camera in OTHER_CAMERAS]
    tasks = {
        (f"{scenario} {camera}".strip(), tracker): [
            Play(scenario, tracker, first + k, camera) for k in range(count)
        ]
        for scenario, tracker, count, camera in plan
        if not scenarios or scenario in scenarios
    }
    found = compare(tasks, chosen_workers(workers, None), "all round")
    print_table(COLUMNS, ([*names, *_figures(runs)] for names, runs in found.items()), width=140)
    for scenario, tracker in TIMED:
        if not scenarios or scenario in scenarios:
            _print_time(scenario, tracker, first)
    for (scenario, _), runs in found.items():
        if scenario == ROUND:
            _print_laps(runs)


def _figures(runs: Sequence[Played]) -> Iterable[str]:
    scores = combine([run.scores for run in runs])
    total = sum(run.distance_m[1] for run in runs)
    distance = sum(run.distance_m[0] * run.distance_m[1] for run in runs if run.distance_m[1]) / max(total, 1)
    yield f"{distance:.3f}"
    yield f"{scores.floor.mean_m:.3f}"
    yield f"{100 * scores.counts.matches / max(scores.counts.targets, 1):.1f}"
    yield from percents(scores, "IDF1")
    yield f"{scores.floor.inside:.1f}"
    yield f"{scores.floor.nees:.2f}"
    yield f"{median(run.update_ms for run in runs):.1f}"


def time_beside_hog(scenario: str, tracker: str, seed: int) -> tuple[float, float]:
    """Return the median times [ms] of a tracker's updates with a new panorama, and of HOG, interleaved."""
    timed, hog = _Timed(_make(tracker, seed)), Hog(uses_colour=True)
    loaded = load_scenario(scenario).mounting((*timed.cameras, COLOUR, THERMAL))
    calibrations = calibrations_of(loaded.world(seed).robot.cameras)
    before, hog_ms = None, []
    cv2.setNumThreads(1)
    for number, (_, seen) in enumerate(islice(blind_drive(loaded, seed), _TIMED_FRAMES)):
        frame, before = Frame.from_observation(seen, before, calibrations), seen.odometry
        timed.update(frame)
        if number % _HOG_EVERY == 0:
            drawn = replace(frame, images={name: frame.images[name] for name in (COLOUR, THERMAL)})
            hog_ms.append(spent_ms(partial(hog.detect, drawn)))
    return median(timed.spent_ms[1:]), median(hog_ms[1:])


def _print_time(scenario: str, tracker: str, seed: int) -> None:
    spent_ms, hog_ms = time_beside_hog(scenario, tracker, seed)
    click.echo(
        f"{scenario} {tracker}: {spent_ms:.2f} ms per image, HOG {hog_ms:.1f} ms; "
        f"scaled to HOG at {_HOG_MS:.0f} ms: {_HOG_MS / hog_ms * spent_ms:.1f} ms"
    )


def _print_laps(runs: Sequence[Played]) -> None:
    kept = sum(len(run.numbers) == 1 for run in runs)
    click.echo(f"{ROUND}: one identity in {kept} of {len(runs)} runs")
    times = np.array([seconds for run in runs for seconds in run.handed_over])
    known = times[~np.isnan(times)]
    click.echo(
        f"a person who enters the thermal image has a box there after {np.mean(known):.2f} s on average, "
        f"{np.percentile(known, 95):.2f} s at the 95th percentile, never in {len(times) - len(known)} of "
        f"{len(times)}"
    )


if __name__ == "__main__":
    call(main, "benchmarks.all_round")
