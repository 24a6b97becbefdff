"""The figures of an episode: those of a run in which the same happens."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict

from peopleboy.scenarios.scores.comfort.comfort_score import ComfortLog
from peopleboy.scenarios.scores.corridor_score import CorridorLog
from peopleboy.scenarios.scores.following_metrics import FollowingTask
from peopleboy.scenarios.scores.following_score import TARGET, FollowingLog, Spot, track_on
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.truth.boxes import Box
from peopleboy.sim.truth.image_free_truth import ImageFreeTruth
from peopleboy.tracker.track import Track

Figures = dict[str, dict[str, float]]


class EpisodeFigures:
    """Keeps what the figures need, one instant after another, and works them out when asked.

    Whom the robot goes after is its controller's secret: `wrong_person_s` is NaN, and `followed_to_end` asks
    for the track only.
    """

    def __init__(self, plan: FloorPlan, task: FollowingTask) -> None:
        self._plan, self._task = plan, task
        self._following, self._corridor, self._comfort = FollowingLog(), CorridorLog(), ComfortLog()

    def add_tracked(self, scene: ImageFreeTruth, tracks: Iterable[Track], box: Box | None) -> None:
        """Take in an instant of which a tracker made tracks; the person to follow truly is in that box."""
        target = next((person for person in scene.people if person.id == TARGET), None)
        spot = None
        if box is not None and target is not None:
            spot = Spot(box, scene.robot.locate(target.position_m))
        self._add(scene, track_on(spot, tracks))

    def add_seen(self, scene: ImageFreeTruth) -> None:
        """Take in an instant without a tracker, at which a person counts as tracked while seen."""
        is_seen = any(person.is_seen for person in scene.people if person.id == TARGET)
        self._add(scene, TARGET if is_seen else 0)

    def metrics(self) -> Figures:
        """Give the groups `following`, `corridor` and `comfort` of a run's metrics.json, or NaN."""
        return {
            "following": asdict(self._following.score(self._task)),
            "corridor": asdict(self._corridor.score(self._plan)),
            "comfort": asdict(self._comfort.score()),
        }

    def _add(self, scene: ImageFreeTruth, track: int) -> None:
        self._following.add(scene, track)
        self._corridor.add(scene)
        self._comfort.add(scene)
