"""Whether somebody who was away is known again at once, and nobody else is taken for that person."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np

from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.loop.loop import make_frame
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.random_streams import stream
from peopleboy.sim.truth.truth import Truth
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import COLOUR, THERMAL
from peopleboy.tracker.track import Status, Track
from peopleboy.tracker.trackers import make_tracker

BACK: Final = 0.6  # visible share from which on somebody is back
GONE: Final = 0.3  # and below which away
OVERLAP: Final = 0.3  # IoU from which on a track is on a person


def watch_absence(scenario: Scenario, seed: int, names: Sequence[str]) -> dict[str, Any]:
    """Play a film in which the first person goes away and comes back, and let trackers watch it.

    Returns:
        Plain data by the tracker's name: "away", images in which the person is away, "accepted", how often
        somebody else had its number then, "late_s", the time from when it is to be seen again until it has
        its number, None for never, and "found_s" the same until it has any.
    """
    trackers = {name: make_tracker(name, stream(seed, "tracker")) for name in names}
    told: dict[str, list[dict[int, str]]] = {name: [] for name in names}
    visible: list[float] = []
    calibrations = calibrations_of(scenario.world(seed).robot.cameras)
    leader, before = "", None
    for world, observation in blind_drive(scenario, seed):
        frame = make_frame(observation, calibrations, before)
        frame.grey(THERMAL), frame.rgb(COLOUR)
        before, truth = observation.odometry, world.truth()
        leader = leader or truth.people[0].name
        visible.append(max((one.visible_fraction for one in truth.people if one.name == leader), default=0.0))
        for name, tracker in trackers.items():
            told[name].append(who_is_who(tracker.update(frame), truth))
    rate_hz = len(visible) / scenario.duration_s
    return {name: judged(rows, visible, leader, rate_hz) for name, rows in told.items()}


def who_is_who(tracks: Sequence[Track], truth: Truth) -> dict[int, str]:
    """Name the person on whom each track that is seen is."""
    found = {}
    for track in tracks:
        if track.status in (Status.TENTATIVE, Status.TOTALLY_OCCLUDED) or THERMAL not in track.boxes:
            continue
        box = np.array(track.boxes[THERMAL])
        shares = {
            person.name: float(iou(box, np.array(person.box)))
            for person in truth.people
            if person.box is not None and person.visible_fraction > 0.1
        }
        best = max(shares, key=lambda name: shares[name], default=None)
        if best is not None and shares[best] > OVERLAP:
            found[track.id] = best
    return found


def judged(
    rows: Sequence[Mapping[int, str]], visible: Sequence[float], leader: str, rate_hz: float
) -> dict[str, float | None]:
    """Give plain data of what a tracker said, image by image, about a person with these visible shares."""
    gone, back = longest_gap(visible)
    numbers = Counter(number for row in rows[:gone] for number, name in row.items() if name == leader)
    own = numbers.most_common(1)[0][0] if numbers else None
    away = rows[gone:back]
    own_again = [k for k, row in enumerate(rows[back:]) if row.get(own or 0) == leader]
    any_again = [k for k, row in enumerate(rows[back:]) if leader in row.values()]
    return {
        "away": len(away),
        "accepted": sum(row.get(own or 0, leader) != leader for row in away),
        "late_s": own_again[0] / rate_hz if own_again else None,
        "found_s": any_again[0] / rate_hz if any_again else None,
    }


def longest_gap(visible: Sequence[float]) -> tuple[int, int]:
    """Find the longest time in which somebody cannot be seen: its first image, and that of the return."""
    seen = [k for k, share in enumerate(visible) if share >= GONE]
    gaps = [(later - one, one, later) for one, later in pairwise(seen)]
    _, gone, later = max(gaps)
    back = next((k for k in range(later, len(visible)) if visible[k] >= BACK), later)
    return gone + 1, back
