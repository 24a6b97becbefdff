"""Attention experiments: focus on the learned person, and re-identification after an absence.

Source: thesis on situation awareness, chapters 5 and 6.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.scenarios.loop.tracker_by_name import OracleTracker, make_named_tracker
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.sim.truth.truth import PersonTruth, Truth
from peopleboy.studies.reproductions.experiment import Floats, Line, Samples, as_columns, ratio
from peopleboy.studies.reproductions.experiments.playback import Moment, play
from peopleboy.studies.reproductions.plan import shortened
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.reproductions.attention.attend import Focus, PersonModel, learn, middle_of, search
from peopleboy.tracker.reproductions.attention.attention_config import PRINTED, AttentionConfig
from peopleboy.tracker.reproductions.attention.image_sums import ImageSums
from peopleboy.tracker.reproductions.attention.part_model import check_box
from peopleboy.tracker.track import Box, Status, Track
from peopleboy.tracker.trackers import make_tracker

if TYPE_CHECKING:
    pass

PRINTED_NAME: Final = "printed"
SUMS: Final = "sums, no common range"
MATCHING: Final = "matching maps"
DEFAULT: Final = "default"

_FREE: Final = replace(PRINTED, inhibits=False, divides_by_peaks=False)
_ABSOLUTE: Final = replace(_FREE, is_absolute=True)
_ALIKE: Final = replace(_ABSOLUTE, reward="same", has_range=False)  # which compares deviations, of any range
_SCALED: Final = replace(_ALIKE, scales=AttentionConfig().scales)
_PLAIN: Final = AttentionConfig(colour=False)

CHOICES: Final[Mapping[str, AttentionConfig]] = {
    PRINTED_NAME: PRINTED,
    "sums, not means": replace(PRINTED, share="sums"),
    "no common range": replace(PRINTED, has_range=False),
    SUMS: replace(PRINTED, share="sums", has_range=False),
    "no maps": replace(PRINTED, plain=False, surround=False),
    "nothing against the box": replace(PRINTED, keeps_negative=False),
    "no number of peaks": replace(PRINTED, divides_by_peaks=False),
    "no lateral inhibition": replace(PRINTED, inhibits=False),
    "neither of them": _FREE,
    "absolute score": _ABSOLUTE,
    "the same, not more": _ALIKE,
    "three sizes": _SCALED,
    MATCHING: _PLAIN,
    "no patterns": replace(_PLAIN, patterns=False),
    "torso alone": replace(_PLAIN, head=False),
    "colour ratio alone": AttentionConfig(maps=False),
    DEFAULT: AttentionConfig(),
}
"""Attention as printed, and with changed settings, by the name used in tables.

Those down to "neither of them" change one or two settings of the printed one; from there on each includes the
changes above it. "matching maps" omits centre-surround, the two below it one more element each; the
default adds the ratio of colours to it.
"""

EVERY: Final = 10
"""Interval between searched frames: 1.5 per second."""
FOLLOWS: Final = "follow_person"
LEARNED: Final = 0.6  # minimum visible share to learn a person
PRESENT: Final = 0.3  # minimum visible share to search for a person
RIGHT, SECOND, WRONG = range(3)

BACK: Final = 0.6  # visible share above which a person is back
GONE: Final = 0.3  # visible share below which a person is away
OVERLAP: Final = 0.3  # minimum IoU of a track on a person
LEAST_VISIBLE: Final = 0.1  # minimum visible share of a person with a track

MAIN: Final = "1"
"""The person who stands nearest to the robot in the scenarios of the sets, as in the thesis's videos."""
FOCUS_SCENARIOS: Final = ("crossing_3", "same_uniform", "crowd_8", "follow_passers_by")
FOCUS_SETS: Final = {"A": ("follow_passers_by",), "B": ("same_uniform", "crowd_8")}
"""Scenarios for the thesis's sets: a person leads the robot past others; people in equal clothes."""
TRACKERS: Final = ("contour", "attentive-printed", "attentive")
FOLLOWERS: Final = ("attentive", "contour")
ABSENCES: Final = ("absence_10s", "absence_60s")
FOLLOWED: Final = "follow_absence"
IN_TIME_S: Final = 1.0

AWAY_S: Final = 8.0
"""A person who is not followed for longer than this counts as absent."""
LEFT_S: Final = 30.0
"""An absence that the end of the run cuts off sooner is not counted, as its outcome is unknown."""


def focus(using: Measurement) -> Samples:
    """Measure how often the focus is on the learned person (table 5.1).

    A video is one run, in which only the first person is searched for, the nearest to the robot.
    """
    found = _focused(using)
    return {
        Line(group, name): as_columns(
            [_focus_shares(_counts([run for scenario in scenarios for run in found[scenario]], name, MAIN))]
        )
        for group, scenarios in FOCUS_SETS.items()
        for name in (PRINTED_NAME, SUMS, MATCHING, DEFAULT)
    }


def _focus_shares(videos: Floats) -> dict[str, float]:
    """Return shares of all images, and means over videos (V, 3), also with the second-best place."""
    right, second, whole = videos[:, RIGHT], videos[:, : SECOND + 1].sum(axis=1), videos.sum(axis=1)
    return {
        "pooled": right.sum() / whole.sum(),
        "per video": float(np.mean(right / whole)),
        "pooled, first two": second.sum() / whole.sum(),
        "per video, first two": float(np.mean(second / whole)),
        "images": whole.sum(),
    }


def focus_variants(using: Measurement) -> Samples:
    """Measure the share of correct focus for each variant of chapter 5, by scenario, one value per seed."""
    return {
        Line(name, "measured"): {
            scenario: np.array([_share_right(_counts([run], name)) for run in runs])
            for scenario, runs in _focused(using).items()
        }
        for name in CHOICES
    }


def _share_right(people: Floats) -> float:
    return ratio(people[:, RIGHT].sum(), people.sum())


def _focused(using: Measurement) -> dict[str, list[Result]]:
    """Return the runs of each scenario, in which all variants of attention search for its people."""
    plan = using.plan
    return using.played(watch_focus, FOCUS_SCENARIOS, plan.drives, tuple(CHOICES), plan.drive_s)


def _counts(runs: Iterable[Result], name: str, person: str = "") -> Floats:
    """Return the focus counts (V, 3) of a variant, for a person of each run, or for all of them."""
    rows = [row for run in runs for key, row in run[name].items() if person in ("", key)]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)


def absences(using: Measurement) -> Samples:
    """Measure re-identification after an absence, and false matches during it, by seed."""
    scenarios = ABSENCES[:1] if using.plan.is_quick else ABSENCES
    found = using.played(watch_absence, scenarios, using.plan.absences, TRACKERS)
    return {
        Line(scenario, name): _recognised([run[name] for run in runs])
        for scenario, runs in found.items()
        for name in TRACKERS
    }


def _recognised(runs: Sequence[Mapping[str, float | None]]) -> dict[str, Floats]:
    columns = {key: np.array([one[key] for one in runs], np.float64) for key in runs[0]}  # None becomes NaN
    late, away = columns["late_s"], columns["away"]
    return {
        "right in time": (late <= IN_TIME_S).astype(np.float64),
        "right at all": np.isfinite(late).astype(np.float64),
        "found in time": (columns["found_s"] <= IN_TIME_S).astype(np.float64),
        "late [s]": late,
        "accepted while away": np.array(list(map(ratio, columns["accepted"], away))),
    }


def followers(using: Measurement) -> Samples:
    """Measure whether a robot resumes following a person after an absence, by seed."""
    seeds = range(using.plan.follows)
    found = using.grouped(
        {name: [Unit.of(watch_follower, FOLLOWED, seed, name) for seed in seeds] for name in FOLLOWERS}
    )
    return {
        Line(FOLLOWED, name): as_columns(
            {
                "resumed": ratio(one["resumed"], one["absences"]),
                "right": one["right"] / one["images"],
                "wrong": one["wrong"] / one["images"],
            }
            for one in runs
        )
        for name, runs in found.items()
    }


def play_focus(scenario: Scenario, seed: int, every: int = EVERY) -> Iterator[Moment]:
    """Play a scenario for the colour camera; a robot that follows a person uses ground truth."""
    if scenario.robot.behaviour != FOLLOWS:
        yield from play(scenario, seed, COLOUR, images=(COLOUR,), every=every)
        return
    from peopleboy.sim.world import SimulatedWorld  # here, as stored results can be read without PyBullet

    config = scenario.world(seed)
    with SimulatedWorld(config) as world:
        oracle, behaviour = OracleTracker(lambda: world.truth()), scenario.make_behaviour()
        for tick in closed_loop(world, oracle, behaviour, round(scenario.duration_s * config.control_hz)):
            if tick.frame % every == 1:
                frame = Frame.from_observation(tick.observation, None, {})
                frame.rgb(COLOUR)  # rendered now, before the world advances
                yield Moment(tick.frame, frame, world.truth(COLOUR), tick.observation)


def wanted(scenario: Scenario, truth: Truth) -> list[PersonTruth]:
    """Return the people to search for: all, or only the first one if the robot follows."""
    is_led = scenario.robot.behaviour == FOLLOWS
    return [person for person in truth.people if not is_led or person.id == 1]


def watch_focus(scenario: str, seed: int, names: Sequence[str], most_s: float) -> Result:
    """Play a clip once, up to a length [s], and search for all people with variants of attention.

    A person is learned once, from the box in the first image that shows most of the person.

    Returns:
        Plain data: by the name in `CHOICES` and the person's id, how often the focus was on the person, how
        often only the second-best place was, and how often neither.
    """
    counts: dict[str, dict[str, list[int]]] = {name: {} for name in names}
    learned: dict[str, dict[int, PersonModel]] = {name: {} for name in names}
    played = shortened(scenario, most_s)
    for moment in play_focus(played, seed):
        people = wanted(played, moment.truth)
        for name in names:
            _search(moment, people, CHOICES[name], learned[name], counts[name])
    return counts


def _search(
    moment: Moment,
    people: Sequence[PersonTruth],
    config: AttentionConfig,
    learned: dict[int, PersonModel],
    counts: dict[str, list[int]],
) -> None:
    sight, image = None, moment.frame.rgb(COLOUR)
    for person in people:
        known = learned.get(person.id)
        if known is not None and person.visible_fraction >= PRESENT:
            sight = sight or ImageSums.of(image, config)
            found = counts.setdefault(str(person.id), [0, 0, 0])
            found[verdict(search(sight, known, config), person, moment.truth)] += 1
        elif known is None and can_be_learned(person, image.shape):
            assert person.box is not None
            sight = sight or ImageSums.of(image, config)
            learned[person.id] = learn(sight, person.box, config)


def can_be_learned(person: PersonTruth, shape: tuple[int, ...]) -> bool:
    """Return whether most of a person is visible, and all of head and torso in the image."""
    if person.box is None or person.visible_fraction < LEARNED:
        return False
    try:
        check_box(person.box, shape)
    except BadInput:
        return False
    return True


def verdict(focus: Focus, person: PersonTruth, truth: Truth) -> int:
    """Return whether the focus, or the second-best place, is on the visible pixels of a person."""
    if _is_on(focus.box, person, truth):
        return RIGHT
    return SECOND if _is_on(focus.second_box, person, truth) else WRONG


def _is_on(box: Box, person: PersonTruth, truth: Truth) -> bool:
    u, v = (round(place) for place in middle_of(box))
    height, width = truth.instance.shape
    return 0 <= v < height and 0 <= u < width and int(truth.instance[v, u]) == person.id


def watch_absence(scenario: str, seed: int, names: Sequence[str]) -> Result:
    """Play a clip in which the first person leaves and comes back, and run trackers on it.

    Returns:
        Plain data by the tracker's name: "away", images in which the person is away, "accepted", how often
        another person had its track then, "late_s", the time from reappearance until the person has its old
        track, None for never, and "found_s" the time until it has any track.
    """
    trackers = {name: make_tracker(name, seed) for name in names}
    tracked: dict[str, list[dict[int, str]]] = {name: [] for name in names}
    visible: list[float] = []
    leader, played = "", load_scenario(scenario)
    for one in play(played, seed, THERMAL, images=(THERMAL, COLOUR)):
        people = one.truth.people
        leader = leader or people[0].name
        visible.append(max((each.visible_fraction for each in people if each.name == leader), default=0.0))
        for name, tracker in trackers.items():
            tracked[name].append(people_of_tracks(tracker.update(one.frame), one.truth))
    rate_hz = len(visible) / played.duration_s
    return {name: score_absence(rows, visible, leader, rate_hz) for name, rows in tracked.items()}


def people_of_tracks(tracks: Sequence[Track], truth: Truth) -> dict[int, str]:
    """Return the person that each visible track is on."""
    found = {}
    for track in tracks:
        if track.status in (Status.TENTATIVE, Status.TOTALLY_OCCLUDED) or THERMAL not in track.boxes:
            continue
        box = np.array(track.boxes[THERMAL])
        shares = {
            person.name: float(iou(box, np.array(person.box)))
            for person in truth.people
            if person.box is not None and person.visible_fraction > LEAST_VISIBLE
        }
        best = max(shares, key=lambda name: shares[name], default=None)
        if best is not None and shares[best] > OVERLAP:
            found[track.id] = best
    return found


def score_absence(
    rows: Sequence[Mapping[int, str]], visible: Sequence[float], leader: str, rate_hz: float
) -> dict[str, float | None]:
    """Score the re-identification of a person, from the people that tracks are on and visible shares."""
    gone, back = longest_gap(visible)
    ids = Counter(number for row in rows[:gone] for number, name in row.items() if name == leader)
    own = ids.most_common(1)[0][0] if ids else None
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
    """Return the longest absence of a person: its first image, and the image of the return."""
    seen = [k for k, share in enumerate(visible) if share >= GONE]
    _, gone, later = max((later - one, one, later) for one, later in pairwise(seen))
    back = next((k for k in range(later, len(visible)) if visible[k] >= BACK), later)
    return gone + 1, back


def watch_follower(scenario: str, seed: int, name: str) -> Result:
    """Run a robot that follows the first person of a scenario, who leaves and comes back, with a tracker.

    Returns:
        Plain data: "images"; "right" and "wrong", the numbers of images in which it follows the person and
        another one; "absences", the number of long interruptions, and "resumed", the number of those after
        which it followed this person again.
    """
    from peopleboy.sim.world import SimulatedWorld  # here, as stored results can be read without PyBullet

    world: SimulatedWorld  # the tracker reads it only when it is built
    tracker = make_named_tracker(name, seed, lambda: world.truth())
    played = load_scenario(scenario).mounting(tracker.cameras)
    config = played.world(seed)
    leader = config.people[0].name
    with SimulatedWorld(config) as world:
        frames = round(played.duration_s * config.control_hz)
        followed = [
            None if tick.following is None else people_of_tracks(tick.tracks, tick.truth).get(tick.following)
            for tick in closed_loop(world, tracker, played.make_behaviour(), frames)
        ]
    after = resumptions(followed, leader, *(round(s * config.control_hz) for s in (AWAY_S, LEFT_S)))
    return {
        "images": len(followed),
        "right": sum(one == leader for one in followed),
        "wrong": sum(one not in (None, leader) for one in followed),
        "absences": len(after),
        "resumed": sum(after),
    }


def resumptions(followed: list[str | None], leader: str, away: int, left: int) -> list[bool]:
    """Return for each absence of a person whether the robot followed this person again after it.

    Args:
        followed: name of the followed person, image by image.
        leader: name of the person.
        away: minimum length of an absence, in images.
        left: minimum length of a last absence, which the end cuts off, in images.
    """
    ours = [k for k, name in enumerate(followed) if name == leader]
    ends = [*ours[1:], len(followed)]
    least = [*(away for _ in ours[1:]), left]
    long = [(k, later) for k, later, most in zip(ours, ends, least, strict=False) if later - k > most]
    return [later < len(followed) and not any(followed[k + 1 : later]) for k, later in long]
