"""Figures of the thesis on people tracking, and figure 4 of the 2005 paper."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.random_streams import stream
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.studies.reproductions.evaluations.playback import play
from peopleboy.studies.reproductions.pictures.canvas import canvas, frame_box, label
from peopleboy.tracker.contour.contour_tracker import ContourTracker
from peopleboy.tracker.contour.explanation import Ellipse
from peopleboy.tracker.contour.measurement.likelihood import ContourModel
from peopleboy.tracker.contour.measurement.section_evidence import outline
from peopleboy.tracker.contour.particles import CROWN, FOOT, H, Y, draw_around, draw_prior
from peopleboy.tracker.contour.variants import THESIS
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import Box

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_GREY, _BLACK, _ORANGE, _BLUE = "#b5bcc6", "#1a1a1a", "#d95f02", "#1f78b4"
_COLOURS: Final = (_BLUE, _ORANGE, "#1b9e77", "#7570b3", "#e7298a")

# Figure 3.4: two people cross, and the tracker makes one kind of error.
_FRAMES: Final = 60
_FIRST, _SECOND = 1, 2  # who walks to the right, and who to the left
_BOX: Final = (40.0, 130.0)  # width and height [px]
_TOP: Final = 60.0
_OFF_PX: Final = (2.0, 4.0)  # by how much every candidate is off

# Figure 5.3: two people come to overlap.
MEETING_SCENE: Final = "leader_swap"
PENALTIES: Final = (10.0, 1.0)
_STREAMS: Final = 6  # random streams of the tracker, all drawn
_BEFORE: Final = 12  # images from where both are made known to where they are drawn
_HIDDEN: Final = 0.2  # share of a person that is hidden where they are drawn
_CONTOUR_COLOURS: Final = ("#ffb000", "#00b3ff")

# Figures 4.4 and 7.2: contours with and without people.
CONTOUR_SCENE: Final = "passers_by"
SEED: Final = 100
_EVERY: Final = 5  # images from one that is looked at to the next
_IMAGES: Final = 30  # of each kind, as in the thesis
_PLAIN: Final = 0.9  # visible fraction from which a person is seen whole
_THRESHOLD_GREY: Final = 22.0  # theta

# Figure 4 of the paper.
SPANS_SCENE: Final = "hall_visits"


@dataclass(frozen=True, slots=True)
class Claimed:
    """The claim of a tracker in one frame: on whom a candidate lies, and its id."""

    frame: int
    person: int
    id: int


def _correct(frame: int) -> list[Claimed]:
    return [Claimed(frame, person, person) for person in (_FIRST, _SECOND)]


def _scattered(frame: int) -> list[Claimed]:
    """Lose the first person for a while, twice, and begin a new track each time."""
    part = frame // 20
    pieces = [Claimed(frame, _FIRST, 10 + part)] if frame % 20 < 15 else []
    return [*pieces, Claimed(frame, _SECOND, _SECOND)]


def _swapped(frame: int) -> list[Claimed]:
    ids = (_SECOND, _FIRST) if frame >= _FRAMES // 2 else (_FIRST, _SECOND)
    return [Claimed(frame, _FIRST, ids[0]), Claimed(frame, _SECOND, ids[1])]


def _fetched(frame: int) -> list[Claimed]:
    """Let both candidates lie on the first person, once the two have met."""
    other = _FIRST if frame >= _FRAMES // 2 else _SECOND
    return [Claimed(frame, _FIRST, _FIRST), Claimed(frame, other, _SECOND)]


ERRORS: Final[Mapping[str, Callable[[int], list[Claimed]]]] = {
    "a) correct": _correct,
    "b) scattering": _scattered,
    "c) swapping": _swapped,
    "d) fetching": _fetched,
}
"""What is claimed in each frame, by the kind of error."""


def score_error(name: str) -> Scores:
    """Score the claims of one kind of error about two people who cross."""
    return evaluate(_true_walks(), _tracks(name), frames=_FRAMES)


def draw_errors() -> Figure:
    """Draw true walks and tracks over time, with the metrics of each error: figure 3.4."""
    page = canvas(4.6)
    for axes, name in zip(page.subplots(2, 2, sharex=True, sharey=True).flat, ERRORS, strict=True):
        _draw_walks(axes, name)
    return page


def _draw_walks(axes: Axes, name: str) -> None:
    truth, tracks, scores = _true_walks(), _tracks(name), score_error(name)
    for person in (_FIRST, _SECOND):
        walk = truth.take(truth.id == person)
        axes.plot(walk.frame, _middle(walk.box), color=_GREY, linewidth=7, solid_capstyle="butt")
    for colour, number in zip(_COLOURS, np.unique(tracks.id).tolist(), strict=False):
        rows = tracks.take(tracks.id == number)
        where = np.full(_FRAMES + 1, np.nan)
        where[rows.frame] = _middle(rows.box)
        axes.plot(where, color=colour, linewidth=1.6)
    thesis, paper, mot = scores.thesis, scores.paper, scores.mot
    metrics = (
        f"CR {thesis.cr:.0f}  CP {thesis.cp:.0f}  AA {thesis.aa:.0f} | OC {paper.oc:.0f}  ADC {paper.adc:.0f}"
        f" | IDF1 {mot.identity.idf1:.0f}"
    )
    label(axes, f"{name}\n{metrics}", "frame", "column [px]")


def _middle(box: Floats) -> Floats:
    return np.asarray(box[:, 0] + box[:, 2] / 2.0)


def _place(frame: int, person: int) -> Box:
    """Return the true box of a person who crosses the image within all frames."""
    way = 200.0 * frame / (_FRAMES - 1)
    return (40.0 + way if person == _FIRST else 240.0 - way, _TOP, *_BOX)


def _true_walks() -> TrueBoxes:
    walks = [(frame, person) for frame in range(_FRAMES) for person in (_FIRST, _SECOND)]
    frame, person = np.array(walks).T
    return _true_boxes(frame + 1, person, np.array([_place(*walk) for walk in walks]))


def _tracks(name: str) -> TrackBoxes:
    claims = [claim for frame in range(_FRAMES) for claim in ERRORS[name](frame)]
    boxes = np.array([_place(claim.frame, claim.person) for claim in claims])
    boxes[:, :2] += _OFF_PX
    frame = np.array([claim.frame + 1 for claim in claims])
    return _track_boxes(frame, np.array([claim.id for claim in claims]), boxes)


def _true_boxes(frame: Ints, number: Ints, box: Floats) -> TrueBoxes:
    count = len(box)
    counted, visible = np.ones(count, np.bool_), np.ones(count)
    return TrueBoxes(frame=frame, id=number, box=box, counted=counted, visible=visible)


def _track_boxes(frame: Ints, number: Ints, box: Floats) -> TrackBoxes:
    return TrackBoxes(frame=frame, id=number, box=box, confidence=np.ones(len(box)))


@dataclass(frozen=True, slots=True, eq=False)
class Example:
    """The one frame of figure 3.5.

    Attributes:
        targets, candidates: (T, 4) and (C, 4) [px] left, top, width, height.
        matches: which target and candidate belong together, of those that overlap by more than half.
    """

    targets: Floats
    candidates: Floats
    matches: tuple[tuple[int, int], ...]


EXAMPLE: Final = Example(
    targets=np.array([(30.0, 50.0, 50.0, 160.0), (140.0, 60.0, 44.0, 140.0), (240.0, 70.0, 40.0, 120.0)]),
    candidates=np.array([(36.0, 58.0, 50.0, 160.0), (144.0, 50.0, 50.0, 140.0), (262.0, 96.0, 40.0, 120.0)]),
    matches=((0, 0), (1, 1)),
)
"""Two are found, and the third candidate overlaps the third person by less than half."""


def score_example() -> Scores:
    """Score the one frame of figure 3.5."""
    frame, number = np.ones(3, np.int64), np.arange(1, 4)
    true = _true_boxes(frame, number, EXAMPLE.targets)
    return evaluate(true, _track_boxes(frame, number, EXAMPLE.candidates), frames=1)


def draw_example() -> Figure:
    """Draw targets, candidates, what they share where they are associated, and the metrics: figure 3.5."""
    page = canvas(3.0)
    axes, text = page.subplots(1, 2, width_ratios=(2, 1))
    for boxes, colour, style in ((EXAMPLE.targets, _BLACK, "-"), (EXAMPLE.candidates, _ORANGE, "--")):
        for box in boxes.tolist():
            frame_box(axes, box, colour, linestyle=style)
    for target, candidate in EXAMPLE.matches:
        box = shared(EXAMPLE.targets[target], EXAMPLE.candidates[candidate])
        frame_box(axes, box, _GREY, hatch="///", linewidth=0)
    axes.set(xlim=(0, 320), ylim=(240, 0), aspect="equal")
    label(axes, "targets: solid; candidates: dashed; counted: hatched", "column [px]", "row [px]")
    thesis, paper = score_example().thesis, score_example().paper
    lines = [f"{name.upper()} {getattr(thesis, name):.1f}" for name in ("cr", "cp", "ca", "ar", "ap", "aa")]
    lines += [f"{name.upper()} {getattr(paper, name):.1f}" for name in ("oar", "bap", "adc")]
    text.text(
        0.1, 0.95, "\n".join(["thesis [%]", *lines[:6], "", "paper [%]", *lines[6:]]), va="top", fontsize=9
    )
    text.axis("off")
    return page


def shared(one: Floats, other: Floats) -> Box:
    """Return the box (left, top, width, height) that two overlapping boxes (4,) share."""
    corner = np.maximum(one[:2], other[:2])
    size = np.minimum(one[:2] + one[2:], other[:2] + other[2:]) - corner
    return float(corner[0]), float(corner[1]), float(size[0]), float(size[1])


@dataclass(frozen=True, slots=True, eq=False)
class Meeting:
    """The images in which two people come to overlap.

    Attributes:
        frames: thermal images with their times, the last of which is drawn.
        boxes: of the two [px] in the first two of these images.
        apart_px: between the middles of their true boxes in the last.
    """

    frames: Sequence[Frame]
    boxes: tuple[Box, Box]
    apart_px: float


def draw_interaction() -> Figure:
    """Draw where random streams end up with a strong and a weak penalty on overlap: figure 5.3."""
    meeting = find_meeting()
    page = canvas(3.0)
    for axes, penalty in zip(page.subplots(1, 2), PENALTIES, strict=True):
        _draw_contours(axes, meeting, penalty)
    return page


def find_meeting() -> Meeting:
    """Play the scenario until a person hides a fifth of another one, and keep the images before.

    Raises:
        RuntimeError: nobody comes to hide anybody.
    """
    frames: list[Frame] = []
    boxes: list[dict[str, Box]] = []
    for moment in play(load_scenario(MEETING_SCENE), SEED, THERMAL):
        people, seen = moment.truth.people, moment.observation
        frames.append(Frame(images={THERMAL: seen.images[THERMAL]}, time_s=seen.time_s))
        boxes.append({one.name: one.box for one in people if one.box is not None})
        pair = [one.name for one in people if one.name in boxes[-1]]
        start = len(frames) - 1 - _BEFORE
        if start < 0 or not any(one.occluded_fraction > _HIDDEN for one in people):
            continue
        if len(pair) == 2 and pair[0] in boxes[start] and pair[1] in boxes[start + 1]:
            left, right = (boxes[-1][name] for name in pair)
            apart_px = abs(left[0] + left[2] / 2.0 - right[0] - right[2] / 2.0)
            return Meeting(frames[start:], (boxes[start][pair[0]], boxes[start + 1][pair[1]]), apart_px)
    raise RuntimeError(f"nobody hides anybody in {MEETING_SCENE}")


def contours_after(meeting: Meeting, penalty: float, number: int) -> list[Ellipse]:
    """Follow the two with a random stream of the literal tracker, and give the contours at the end."""
    config = replace(THESIS, interaction=replace(THESIS.interaction, penalty=penalty))
    tracker = ContourTracker(config, stream(number, "reproduce.interaction"))
    for box, frame in zip((*meeting.boxes, *[None] * len(meeting.frames)), meeting.frames, strict=False):
        if box is not None:
            tracker.introduce(box)
        tracker.update(frame)
    return list(tracker.explanation.ellipses.values())


def _draw_contours(axes: Axes, meeting: Meeting, penalty: float) -> None:
    axes.imshow(meeting.frames[-1].grey(THERMAL), cmap="gray", vmin=0, vmax=255)
    gaps = []
    for number in range(_STREAMS):
        contours = contours_after(meeting, penalty, number)
        gaps += [abs(contours[0].x - contours[1].x)] if len(contours) > 1 else []
        for colour, ellipse in zip(_CONTOUR_COLOURS, contours, strict=False):
            for line in outline(ellipse):
                axes.plot(*line.T, color=colour, linewidth=0.9)
    axes.set(xticks=[], yticks=[])
    apart = f"{np.mean(gaps):.0f} px apart; truth {meeting.apart_px:.0f} px" if gaps else "none keeps both"
    label(axes, f"rho = {penalty:g}: {apart}; {len(gaps)} of {_STREAMS} keep both")


@dataclass(frozen=True, slots=True, eq=False)
class ThermalMoment:
    """A thermal image (H, W), and who is in it."""

    image: NDArray[np.uint8]
    people: Sequence[PersonTruth]

    @property
    def whole(self) -> list[PersonTruth]:
        """Those who are seen whole."""
        return [one for one in self.people if one.visible_fraction > _PLAIN and one.box is not None]


def thermal_moments() -> Iterator[ThermalMoment]:
    """Play the scenario, and give every fifth image."""
    for moment in play(load_scenario(CONTOUR_SCENE), SEED, THERMAL, every=_EVERY):
        people = [one for one in moment.truth.people if one.visible_px > 0]
        yield ThermalMoment(np.asarray(moment.observation.images[THERMAL], np.uint8), people)


def draw_fitness() -> Figure:
    """Draw how many samples of the prior fit how well, without and with a person: figure 4.4."""
    moments = list(thermal_moments())
    kinds = {
        "30 images without a person": [one for one in moments if not one.people],
        "30 images with a person": [one for one in moments if one.whole],
    }
    page, rng = canvas(2.6), stream(SEED, "reproduce.fitness")
    left, right = page.subplots(1, 2, sharey=True)
    for axes, (title, found) in zip((left, right), kinds.items(), strict=True):
        prior = (THESIS.detector.count, found[0].image.shape, THESIS.motion, THESIS.detector)
        fits = [fitness_grey(one.image, draw_prior(*prior, rng)) for one in found[:_IMAGES]]
        axes.hist(np.concatenate(fits), bins=np.arange(-42, 43, 2).tolist(), log=True, color=_ORANGE)
        axes.axvline(_THRESHOLD_GREY, color=_BLACK, linestyle="--", linewidth=1)
        label(axes, title, "fitness [grey]; dashed: the threshold", "samples")
    return page


def draw_cues() -> Figure:
    """Draw strength, top and bottom of contours over the distance of their people: figure 7.2."""
    rows = [row for moment in thermal_moments() for row in _cues(moment)]
    distance, *cues = np.array(rows).T
    page = canvas(2.6)
    names = ("strength [grey]", "top [row]", "bottom [row]")
    for axes, values, name in zip(page.subplots(1, 3), cues, names, strict=True):
        axes.plot(distance, values, ".", color=_ORANGE, markersize=3)
        label(axes, name, "distance [m]")
        if name.endswith("[row]"):
            axes.invert_yaxis()
    return page


def fitness_grey(thermal: NDArray[np.uint8], state: NDArray[np.float32]) -> Floats:
    """Return the fitness (N,) of samples (N, 9) in grey: equation 4.3, with the literal tracker's cap."""
    height, width = thermal.shape
    model = ContourModel.build((height, width), THESIS.contour)
    differences = model.differences(model.prepare(thermal), state).astype(np.float64)
    return np.asarray(differences @ model.weights * THESIS.contour.saturation_grey)


def _cues(moment: ThermalMoment) -> Iterator[tuple[float, float, float, float]]:
    """Return distance, strength, top and bottom of the contour that fits best around each whole person."""
    rng = stream(SEED, "reproduce.cues")
    for person in moment.whole:
        assert person.box is not None
        state = draw_around(person.box, THESIS, rng)
        fit = fitness_grey(moment.image, state)
        best = state[int(fit.argmax())]
        top, bottom = best[Y] - CROWN * best[H], best[Y] + FOOT * best[H]
        yield person.distance_m, float(fit.max()), float(top), float(bottom)


def draw_time_ranges() -> Figure:
    """Draw a line for each person over the images in which it is counted and in sight: paper, figure 4."""
    seen: dict[str, list[int]] = {}
    for moment in play(load_scenario(SPANS_SCENE), 0, THERMAL):
        for person in moment.truth.people:
            if person.is_counted and person.visible_px > 0:
                seen.setdefault(person.name, []).append(moment.number)
    page = canvas(0.8 + 0.18 * len(seen))
    axes = page.subplots()
    for row, frames in enumerate(seen.values(), 1):
        spans = [(start, end + 1 - start) for start, end in stretches(frames)]
        axes.broken_barh(spans, (row - 0.35, 0.7), color=_BLUE)
    axes.set_yticks(range(1, len(seen) + 1), list(seen))
    label(axes, "", "image")
    return page


def stretches(frames: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Return first and last of each unbroken run of ascending numbers."""
    if frames:
        for run in np.split(np.array(frames), np.flatnonzero(np.diff(frames) > 1) + 1):
            yield int(run[0]), int(run[-1])
