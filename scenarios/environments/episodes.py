"""Episodes in many worlds: rewards, terminations, events and metrics; a single environment has one."""

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
from peopleboy.scenarios.scores.following_metrics import FollowingTask, Spot, score_following, track_on
from peopleboy.sim.batch.sensing import Snapshot
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.shapes.shape_table import Numbers, ends
from peopleboy.sim.truth.scenes import ImageFreeTruth, Scenes
from peopleboy.sim.truth.truth import Box
from peopleboy.tracker.track import Track

Metrics = dict[str, dict[str, float]]


class EpisodeMetrics:
    """Keeps the snapshots of an episode, and computes its metrics on demand, as those of a run.

    Only the controller knows which person it follows: `wrong_person_s` is NaN, and `followed_to_end` asks for
    the track only.
    """

    def __init__(self, plan: FloorPlan, task: FollowingTask) -> None:
        self._plan, self._task = plan, task
        self._noted: list[tuple[Scenes, int, int]] = []

    def add(self, scenes: Scenes, row: int, track: int) -> None:
        """Take in an instant.

        Args:
            scenes: of many worlds.
            row: of the one in which the episode is.
            track: number of the track that lies on the person to follow, 0 for none.
        """
        self._noted.append((scenes, row, track))

    def metrics(self) -> Metrics:
        """Return the groups `following`, `corridor` and `comfort` of a run's metrics.json, or NaN."""
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
        return {
            "following": asdict(score_following(drive, self._task)),
            "corridor": asdict(score_corridor(drive, legs_of(self._plan))),
            "comfort": asdict(score_comfort(drive)),
        }


def track_in(scenes: Scenes, row: int, tracks: Iterable[Track], box: Box | None, before: int) -> int:
    """Return the number of the track that lies on the person to follow in one world, 0 for none.

    Args:
        scenes: of many worlds.
        row: of that one.
        tracks: that a tracker made there.
        box: in which the person truly is in the thermal image.
        before: the track that lay there last, 0 for none.
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
        plan: of the place.
        following: how the person is to be followed.
        frames: steps after which time is over.
        dt_s: [s] length of a step.
        limits: [m/s, rad/s] of the drive.
    """

    plan: FloorPlan
    following: FollowingTask
    frames: int
    dt_s: float
    limits: tuple[float, float]


class StepOutcomes(NamedTuple):
    """What came of a step in G worlds.

    Attributes:
        terms: (G, 8) of the reward, in the order of `TERMS`.
        rewards: (G,) their sums.
        terminations, truncations: (G,) whether the episodes are over.
        events: what is new, and to or with whom.
        truths: what is true.
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
        records: (B,) EPISODE of the last one in each world, over or not.
    """

    def __init__(self, count: int, task: str) -> None:
        self.records = np.zeros(count, EPISODE)
        self.records["is_over"] = True
        self._task = TASKS.index(task)
        self._plans = [np.zeros((0, 4))] * count
        self._touched: list[set[str]] = [set() for _ in range(count)]
        self._metrics: dict[int, EpisodeMetrics] = {}
        self._lay_out()

    def begin(
        self, number: int, settings: EpisodeSettings, snapshot: Snapshot, tracks: Sequence[int] | None
    ) -> StepOutcomes:
        """Begin an episode in one of the worlds.

        Args:
            number: of the world.
            settings: of the episode.
            snapshot: the first one, in that world alone.
            tracks: see `evaluate`.
        """
        self.records[number] = np.zeros((), EPISODE)
        own = self.records[number : number + 1]
        own["start"], own["frame"], own["frames"] = snapshot.odometry, -1, settings.frames
        own["dt_s"], own["keep_m"], own["limits"] = settings.dt_s, settings.following.keep_m, settings.limits
        self._plans[number], self._touched[number] = areas_of(settings.plan), set()
        self._metrics[number] = EpisodeMetrics(settings.plan, settings.following)
        self._lay_out()
        outcomes = self.evaluate(snapshot, np.zeros((1, 2)), tracks)
        own["is_over"] = False
        return outcomes._replace(terms=np.zeros_like(outcomes.terms), rewards=[0.0])

    def evaluate(self, snapshot: Snapshot, actions: Array, tracks: Sequence[int] | None) -> StepOutcomes:
        """Take in the next snapshot of some episodes, and return what came of the step.

        Args:
            snapshot: of G worlds, by their numbers.
            actions: (G, 2) that led there.
            tracks: of each the number of the track that lies on the person to follow, 0 for none; None where
                there is no tracker, and a person counts as tracked while seen.
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
        """Return the metrics of an episode so far, see `EpisodeMetrics`."""
        return self._metrics[number].metrics()

    def _compare(
        self, numbers: Numbers, scenes: Scenes, before: NDArray[np.uint64], now: NDArray[np.uint64]
    ) -> list[Events]:
        """Return what is new since the snapshot before; `before` and `now` are who was and is seen."""
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
        """Put the areas of all places into one array."""
        self._areas = np.concatenate(self._plans)
        self._first_area = ends([len(areas) for areas in self._plans])
