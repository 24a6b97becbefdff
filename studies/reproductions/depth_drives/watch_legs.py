"""Following one person by legs and by depth and colour at the same time (SA 4.7.7)."""

from __future__ import annotations

from typing import Any

from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.studies.reproductions.depth_drives.legs import CAMERAS, LegTracker, scan
from peopleboy.studies.reproductions.depth_drives.play_drive import play_drive, with_cameras
from peopleboy.studies.reproductions.depth_drives.tracker_choices import DEFAULT
from peopleboy.studies.reproductions.depth_drives.watch_drive import Watcher, truth_row


def watch_legs(scenario: Scenario, seed: int) -> dict[str, Any]:
    """Play a drive with a laser's stand-in near the floor.

    Returns:
        Plain data: "truth" as of `watch_drive`, and "depth" and "legs", rows of frame, track, place forward
        and left of the robot [m].
    """
    watcher, legs = Watcher(DEFAULT), LegTracker()
    truth: list[tuple[float, ...]] = []
    told: list[tuple[float, ...]] = []
    for moment in play_drive(with_cameras(scenario, CAMERAS), seed):
        watcher.see(moment)
        tracks = legs.update(scan(moment.observation), moment.frame.odometry)
        told += [(moment.number, one.id, *(round(value, 3) for value in one.place_m)) for one in tracks]
        truth += [truth_row(moment.number, person) for person in moment.people]
    return {"truth": truth, "depth": watcher.plain()["told"], "legs": told}
