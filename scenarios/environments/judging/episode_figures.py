"""The figures of an episode: those of a run in which the same happens."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict

import numpy as np

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.scores.comfort_metrics import score_company
from peopleboy.scenarios.scores.corridor_metrics import score_way
from peopleboy.scenarios.scores.following_metrics import FollowingTask
from peopleboy.scenarios.scores.following_score import TARGET, Spot, score_instants, track_on
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.truth.scenes import Scenes
from peopleboy.sim.truth.truth import Box
from peopleboy.tracker.track import Track

Figures = dict[str, dict[str, float]]


class EpisodeFigures:
    """Keeps the snapshot of an episode, and works the figures out when asked.

    Whom the robot goes after is its controller's secret: `wrong_person_s` is NaN, and `followed_to_end` asks
    for the track only.
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

    def metrics(self) -> Figures:
        """Give the groups `following`, `corridor` and `comfort` of a run's metrics.json, or NaN."""
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
        time_s, robot, contact = worlds["time_s"], worlds["robot"], worlds["is_touching"]
        track, nobody_knows = [number for _, _, number in self._noted], np.full(len(worlds), np.nan)
        following = np.column_stack([time_s, robot, target, contact, track, nobody_knows])
        company = np.column_stack([time_s, robot, worlds["velocity"][:, 0], counts])
        return {
            "following": asdict(score_instants(following, self._task)),
            "corridor": asdict(score_way(np.column_stack([time_s, robot, contact]), self._plan)),
            "comfort": asdict(
                score_company(company, np.column_stack([people["position_m"], people["velocity_m_s"]]))
            ),
        }


def track_in(scenes: Scenes, row: int, tracks: Iterable[Track], box: Box | None, before: int) -> int:
    """Give the number of the track that lies on the person to follow in one world, 0 for none.

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
