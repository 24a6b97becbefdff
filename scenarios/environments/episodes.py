"""Episodes in many worlds: rewards, terminations, events and metrics; a single environment has one world."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.environments.rewards import (
    ENDS,
    EPISODE,
    TASKS,
    TERMS,
    Array,
    areas_of,
    compute_rewards,
)
from peopleboy.scenarios.scores.comfort_metrics import score_comfort
from peopleboy.scenarios.scores.corridor_metrics import legs_of, score_corridor
from peopleboy.scenarios.scores.drive_record import TARGET, DriveRecord
from peopleboy.scenarios.scores.episode_result import DriveScores, EpisodeResult
from peopleboy.scenarios.scores.following_metrics import FollowingTask, Spot, score_following, track_on
from peopleboy.scenarios.scores.goal_metrics import GoalTask, score_goal
from peopleboy.sim.batch.sensing import Snapshot
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.shapes.shape_table import Numbers, ends
from peopleboy.sim.truth.scenes import ImageFreeTruth, Scenes
from peopleboy.sim.truth.truth import Box
from peopleboy.tracker.track import Track

Metrics = dict[str, dict[str, float]]

_END_NAMES: Final = tuple(TERMS[end] for end in ENDS)


class EpisodeMetrics:
    """Collect the snapshots of an episode, and compute its metrics on demand, as for a run.

    The environment does not know which person a controller follows: `wrong_person_s` is NaN, and
    `followed_to_end` depends on the track alone.
    """

    def __init__(self, plan: FloorPlan, task: FollowingTask, goal: GoalTask | None) -> None:
        self._plan, self._task, self._goal = plan, task, goal
        self._noted: list[tuple[Scenes, int, int]] = []

    def add(self, scenes: Scenes, row: int, track: int) -> None:
        """Add an instant.

        Args:
            scenes: instant in many worlds.
            row: row of the episode's world.
            track: id of the track on the person to follow, 0 for none.
        """
        self._noted.append((scenes, row, track))

    def scores(self) -> DriveScores:
        """Return the scores of the drive."""
        worlds = np.concatenate([scenes.worlds[row : row + 1] for scenes, row, _ in self._noted])
        borders = zip(worlds["first"].tolist(), worlds["end"].tolist(), strict=True)
        people = np.concatenate(
            [
                scenes.people[first:end]
                for (scenes, _, _), (first, end) in zip(self._noted, borders, strict=True)
            ]
        )
        counts, is_target = worlds["end"] - worlds["first"], people["id"] == TARGET
        target = np.full((len(worlds), 2), np.nan)
        target[np.repeat(np.arange(len(worlds)), counts)[is_target]] = people["position_m"][is_target]
        drive = DriveRecord(
            time_s=worlds["time_s"],
            robot=worlds["robot"],
            speed_m_s=worlds["velocity"][:, 0],
            is_contact=worlds["is_touching"],
            target=target,
            track=np.array([number for _, _, number in self._noted]),
            is_wrong=None,
            count=counts,
            people=np.column_stack([people["position_m"], people["velocity_m_s"]]),
        )
        return DriveScores(
            goal=None if self._goal is None else score_goal(drive, self._goal),
            following=score_following(drive, self._task),
            corridor=score_corridor(drive, legs_of(self._plan)),
            comfort=score_comfort(drive),
        )


def track_in(scenes: Scenes, row: int, tracks: Iterable[Track], box: Box | None, before: int) -> int:
    """Return the id of the track on the person to follow in one world, 0 for none.

    Args:
        scenes: instant in many worlds.
        row: row of the world.
        tracks: tracks of a tracker in that world.
        box: true box of the person in the thermal image.
        before: id of the last track on the person, 0 for none.
    """
    world = scenes.worlds[row]
    own = scenes.people[world["first"] : world["end"]]
    target = own[own["id"] == TARGET]
    spot = None
    if box is not None and len(target):
        x, y = target["position_m"][0].tolist()
        spot = Spot(box, Pose2(*world["robot"].tolist()).to_local((x, y)))
    return track_on(spot, tracks, before)


Events = tuple[tuple[str, str], ...]
_TWO: Final = 2.0  # see `compute_rewards`


class EpisodeSettings(NamedTuple):
    """The place and the limits of one episode.

    Attributes:
        plan: floor plan of the place.
        following: settings of the task to follow a person.
        goal: place to drive to; None without one.
        frames: steps after which the episode is truncated.
        dt_s: [s] length of a step.
        limits: [m/s, rad/s] speed limits of the drive.
    """

    plan: FloorPlan
    following: FollowingTask
    goal: GoalTask | None
    frames: int
    dt_s: float
    limits: tuple[float, float]


class StepOutcomes(NamedTuple):
    """Outcome of a step in G worlds.

    Attributes:
        terms: (G, 10) terms of the reward, in the order of `TERMS`.
        rewards: (G,) sums of the terms.
        terminations, truncations: (G,) whether the episodes are over.
        events: new events, each with the name of the other party.
        truths: ground truth.
    """

    terms: Array
    rewards: list[float]
    terminations: NDArray[np.bool_]
    truncations: NDArray[np.bool_]
    events: list[Events]
    truths: list[ImageFreeTruth]


class LiveEpisodes:
    """The episodes of B worlds.

    Attributes:
        records: (B,) EPISODE, the current or last episode of each world.
    """

    def __init__(self, count: int, task: str) -> None:
        self.records = np.zeros(count, EPISODE)
        self.records["is_over"] = True
        self._task = TASKS.index(task)
        self._plans = [np.zeros((0, 4))] * count
        self._touched: list[set[str]] = [set() for _ in range(count)]
        self._metrics: dict[int, EpisodeMetrics] = {}
        self._terms: dict[int, list[Array]] = {}
        self._lay_out()

    def begin(
        self, number: int, settings: EpisodeSettings, snapshot: Snapshot, tracks: Sequence[int] | None
    ) -> StepOutcomes:
        """Begin an episode in one of the worlds.

        Args:
            number: number of the world.
            settings: settings of the episode.
            snapshot: first snapshot, of that world alone.
            tracks: see `evaluate`.
        """
        self.records[number] = np.zeros((), EPISODE)
        own = self.records[number : number + 1]
        own["start"], own["frame"], own["frames"] = snapshot.odometry, -1, settings.frames
        goal_m = (math.nan, math.nan) if settings.goal is None else settings.goal.goal_m
        own["goal"], own["away_m"] = goal_m, math.dist(goal_m, snapshot.scenes.worlds["robot"][0, :2])
        own["dt_s"], own["keep_m"], own["limits"] = settings.dt_s, settings.following.keep_m, settings.limits
        self._plans[number], self._touched[number] = areas_of(settings.plan), set()
        self._metrics[number] = EpisodeMetrics(settings.plan, settings.following, settings.goal)
        self._terms[number] = []
        self._lay_out()
        outcomes = self.evaluate(snapshot, np.zeros((1, 2)), tracks)
        own["is_over"], self._terms[number] = False, []
        return outcomes._replace(terms=np.zeros_like(outcomes.terms), rewards=[0.0])

    def evaluate(self, snapshot: Snapshot, actions: Array, tracks: Sequence[int] | None) -> StepOutcomes:
        """Add the next snapshot of some episodes, and return the outcome of the step.

        Args:
            snapshot: snapshot of G worlds.
            actions: (G, 2) actions that led to it.
            tracks: id of the track on the person to follow in each world, 0 for none; None if there is no
                tracker, in which case a visible person counts as tracked.
        """
        numbers, scenes, records = snapshot.numbers, snapshot.scenes, self.records
        records["frame"][numbers] += 1
        seen, terms = records["seen"][numbers], np.empty((len(numbers), len(TERMS)))
        compute_rewards(
            self._task, numbers, records, scenes.worlds, scenes.people, self._areas, self._first_area,
            actions, _TWO, terms,
        )  # fmt: skip
        now = records[numbers]
        if tracks is None:
            tracks = (now["seen"] & np.uint64(1)).tolist()  # whether the first person is seen
        is_noted = (now["frame"] < now["frames"]).tolist()
        for row, (number, notes) in enumerate(zip(numbers.tolist(), is_noted, strict=True)):
            self._terms[number].append(terms[row])
            if notes:
                self._metrics[number].add(scenes, row, tracks[row])
        return StepOutcomes(
            terms=terms,
            rewards=list(map(math.fsum, terms.tolist())),
            terminations=(terms[:, ENDS] != 0.0).any(axis=1),
            truncations=now["frame"] >= now["frames"],
            events=self._compare(numbers, scenes, seen, now["seen"]),
            truths=scenes.truths(),
        )

    def metrics(self, number: int) -> Metrics:
        """Return the groups `goal`, `following`, `corridor`, `comfort` of metrics.json; NaN if undefined."""
        return {name: asdict(group) for name, group in self._metrics[number].scores().groups.items()}

    def result(self, number: int) -> EpisodeResult:
        """Return scores, rewards and end of an episode so far."""
        terms = np.array(self._terms[number], np.float64).reshape(-1, len(TERMS))
        own = self.records[number]
        ends = (terms[-1:, ENDS] != 0.0).any(axis=0)
        ended = next((name for name, is_it in zip(_END_NAMES, ends.tolist(), strict=True) if is_it), "")
        return EpisodeResult(
            task=TASKS[self._task],
            scores=self._metrics[number].scores(),
            terms=TERMS,
            rewards=terms,
            ended=ended or ("time" if own["frame"] >= own["frames"] else ""),
        )

    def _compare(
        self, numbers: Numbers, scenes: Scenes, before: NDArray[np.uint64], now: NDArray[np.uint64]
    ) -> list[Events]:
        """Return the new events; bits of `before` and `now` mark the people visible before and now."""
        touching = self.records["is_touching"]
        is_new = (before != now) | touching[numbers] | scenes.worlds["is_touching"]
        touching[numbers] = scenes.worlds["is_touching"]
        events: list[Events] = [()] * len(numbers)
        for row in np.flatnonzero(is_new).tolist():
            names, contacts = scenes.names[row], set(scenes.contacts[row])
            appeared, gone = (
                [name for k, name in enumerate(names) if bits >> k & 1]
                for bits in (int(now[row] & ~before[row]), int(before[row] & ~now[row]))
            )
            touched, self._touched[numbers[row]] = self._touched[numbers[row]], contacts
            found = [("seen", name) for name in sorted(appeared)]
            found += [("out of sight", name) for name in sorted(gone)]
            found += [("contact", name) for name in sorted(contacts - touched)]
            events[row] = tuple(found)
        return events

    def _lay_out(self) -> None:
        """Concatenate the areas of all places into one array."""
        self._areas = np.concatenate(self._plans)
        self._first_area = ends([len(areas) for areas in self._plans])
