"""Attention: whether its focus is on the person that it learned, and whether that person is recognised again.

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
from peopleboy.tracker.attention.attend import Focus, PersonModel, learn, middle_of, search
from peopleboy.tracker.attention.attention_config import PRINTED, AttentionConfig
from peopleboy.tracker.attention.image_sums import ImageSums
from peopleboy.tracker.attention.part_model import check_box
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.track import Box, Status, Track
from peopleboy.tracker.trackers import make_tracker

if TYPE_CHECKING:
    pass

PRINTED_NAME: Final = "printed"
MATCHING: Final = "matching maps"
DEFAULT: Final = "default"

_MEANS: Final = replace(PRINTED, share="means")
_FREE: Final = replace(_MEANS, inhibits=False, divides_by_peaks=False)
_ABSOLUTE: Final = replace(_FREE, is_absolute=True)
_ALIKE: Final = replace(_ABSOLUTE, reward="same")
_SCALED: Final = replace(_ALIKE, scales=AttentionConfig().scales)
_PLAIN: Final = AttentionConfig(colour=False)

CHOICES: Final[Mapping[str, AttentionConfig]] = {
    PRINTED_NAME: PRINTED,
    "means, not sums": _MEANS,
    "nothing against the box": replace(_MEANS, keeps_negative=False),
    "no number of peaks": replace(_MEANS, divides_by_peaks=False),
    "no lateral inhibition": replace(_MEANS, inhibits=False),
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
"""Attention as printed, and with settings changed, by the name that tables have for it.

Those down to "neither of them" change one setting, or both, of "means, not sums"; from there on each has what
the ones above it have. "matching maps" leaves out centre-surround, the two below it one thing more; the
default adds the ratio of colours to it.
"""

EVERY: Final = 10
"""Frames from one that is searched to the next: 1.5 a second."""
FOLLOWS: Final = "follow_person"
LEARNED: Final = 0.6  # visible share from which on a person can be learned
PRESENT: Final = 0.3  # likewise searched for
RIGHT, SECOND, WRONG = range(3)

BACK: Final = 0.6  # visible share from which on a person is back
GONE: Final = 0.3  # and below which away
OVERLAP: Final = 0.3  # IoU from which on a track is on a person
LEAST_VISIBLE: Final = 0.1  # share of a person on whom a track can be

FOCUS_SCENARIOS: Final = ("crossing_3", "same_uniform", "crowd_8", "follow_passers_by")
FOCUS_SETS: Final = {"A": ("follow_passers_by",), "B": ("same_uniform", "crowd_8")}
"""Scenarios for the thesis's sets: a person who leads the robot past others; people dressed alike."""
TRACKERS: Final = ("contour", "attentive-printed", "attentive")
FOLLOWERS: Final = ("attentive", "contour")
ABSENCES: Final = ("absence_10s", "absence_60s")
FOLLOWED: Final = "follow_absence"
IN_TIME_S: Final = 1.0

AWAY_S: Final = 8.0
"""A person is away who is not followed for longer than this."""
LEFT_S: Final = 30.0
"""An absence that the run's end cuts off sooner is not counted: how it would have ended is unknown."""


def focus(using: Measurement) -> Samples:
    """Measure how often the focus is on the learned person, a video being one person of one run (5.1)."""
    found = _focused(using)
    return {
        Line(group, name): as_columns(
            [_focus_shares(_counts([run for scenario in scenarios for run in found[scenario]], name))]
        )
        for group, scenarios in FOCUS_SETS.items()
        for name in (PRINTED_NAME, MATCHING, DEFAULT)
    }


def _focus_shares(videos: Floats) -> dict[str, float]:
    """Return shares of all images together, and means of videos (V, 3), also with the second best place."""
    right, second, whole = videos[:, RIGHT], videos[:, : SECOND + 1].sum(axis=1), videos.sum(axis=1)
    return {
        "pooled": right.sum() / whole.sum(),
        "per video": float(np.mean(right / whole)),
        "pooled, first two": second.sum() / whole.sum(),
        "per video, first two": float(np.mean(second / whole)),
        "images": whole.sum(),
    }


def focus_variants(using: Measurement) -> Samples:
    """Measure the share of right focus with each reading of chapter 5, by scenario, one value a seed."""
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
    """Return the runs of each scenario, in which all variants of attention look for its people."""
    plan = using.plan
    return using.played(watch_focus, FOCUS_SCENARIOS, plan.drives, tuple(CHOICES), plan.drive_s)


def _counts(runs: Iterable[Result], name: str) -> Floats:
    """Return what a variant's focus was on, (V, 3), for each person of each run."""
    return np.array([row for run in runs for row in run[name].values()], dtype=np.float64).reshape(-1, 3)


def absences(using: Measurement) -> Samples:
    """Measure who is recognised after an absence, and who is taken for that person meanwhile, by seed."""
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
    """Measure whether a robot goes on with the person who was away, by seed."""
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
    """Play a scenario for the colour camera; a robot that follows a person is given the truth to follow."""
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
                frame.rgb(COLOUR)  # drawn now, as the world goes on
                yield Moment(tick.frame, frame, world.truth(COLOUR), tick.observation)


def wanted(scenario: Scenario, truth: Truth) -> list[PersonTruth]:
    """List the people who are searched for: everybody, or the first one if the robot follows."""
    is_led = scenario.robot.behaviour == FOLLOWS
    return [person for person in truth.people if not is_led or person.id == 1]


def watch_focus(scenario: str, seed: int, names: Sequence[str], most_s: float) -> Result:
    """Play a clip, cut where it is longer [s], once, and search for everybody in it by kinds of attention.

    A person is learned from the box in the first image that shows most of it, and not again.

    Returns:
        Plain data: by the name in `CHOICES` and the person's id how often the focus was on the person, how
        often only the second best place was, and how often neither.
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
    """Return whether the focus, or the second best place, is on the visible pixels of a person."""
    if _is_on(focus.box, person, truth):
        return RIGHT
    return SECOND if _is_on(focus.second_box, person, truth) else WRONG


def _is_on(box: Box, person: PersonTruth, truth: Truth) -> bool:
    u, v = (round(place) for place in middle_of(box))
    height, width = truth.instance.shape
    return 0 <= v < height and 0 <= u < width and int(truth.instance[v, u]) == person.id


def watch_absence(scenario: str, seed: int, names: Sequence[str]) -> Result:
    """Play a clip in which the first person goes away and comes back, and let trackers see it.

    Returns:
        Plain data by the tracker's name: "away", images in which the person is away, "accepted", how often
        another person had its track then, "late_s", the time from when it is visible again until it has its
        track, None for never, and "found_s" the same until it has any.
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
    """Name the person on whom each visible track is."""
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
    """Score the tracks of each image, by the person on whom they are, about a person with visible shares."""
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
    """Find the longest time in which a person is not visible: its first image, and that of the return."""
    seen = [k for k, share in enumerate(visible) if share >= GONE]
    _, gone, later = max((later - one, one, later) for one, later in pairwise(seen))
    back = next((k for k in range(later, len(visible)) if visible[k] >= BACK), later)
    return gone + 1, back


def watch_follower(scenario: str, seed: int, name: str) -> Result:
    """Let a robot follow the first person of a scenario, who goes away and comes back, with a tracker.

    Returns:
        Plain data: "images"; "right" and "wrong", in how many it follows the person and another one;
        "absences", how often it did not follow the person for longer, and "resumed", after how many of those
        it went on with this person.
    """
    from peopleboy.sim.world import SimulatedWorld  # here, as stored results can be read without PyBullet

    world: SimulatedWorld  # the tracker looks at it only once it is built
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
    """Return for each absence of a person whether the robot went on with this person after it.

    Args:
        followed: name of the person that is followed, image by image.
        leader: the person's name.
        away: images from which on an absence counts ...
        left: ... and of the last one, which the end cuts off.
    """
    ours = [k for k, name in enumerate(followed) if name == leader]
    ends = [*ours[1:], len(followed)]
    least = [*(away for _ in ours[1:]), left]
    long = [(k, later) for k, later, most in zip(ours, ends, least, strict=False) if later - k > most]
    return [later < len(followed) and not any(followed[k + 1 : later]) for k, later in long]
