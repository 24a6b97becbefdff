"""Draw the figures of the thesis on people tracking, and figure 4 of the 2005 paper."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from peopleboy.random_streams import stream
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.studies.reproductions.canvas import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    canvas,
    frame_box,
    label,
    single,
)
from peopleboy.studies.reproductions.experiments.playback import Moment, play, unbroken
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.reproductions.contour.contour_tracker import ContourTracker
from peopleboy.tracker.reproductions.contour.explanation import Ellipse
from peopleboy.tracker.reproductions.contour.measurement.likelihood import ContourModel
from peopleboy.tracker.reproductions.contour.measurement.section_evidence import outline
from peopleboy.tracker.reproductions.contour.particles import CROWN, FOOT, H, Y, draw_around, draw_prior
from peopleboy.tracker.reproductions.contour.variants import THESIS, THESIS_SINGLE
from peopleboy.tracker.track import Box

Floats = NDArray[np.float64]

_COLOURS: Final = (BLUE, ORANGE, GREEN, "#7570b3", PINK)

# Figure 3.4: two people cross, and the tracker makes one kind of error.
_FRAMES: Final = 60
_FIRST, _SECOND = 1, 2  # the person who walks to the right, and the one who walks to the left
_BOX: Final = (40.0, 130.0)  # width and height [px]
_TOP: Final = 60.0
_OFF_PX: Final = (2.0, 4.0)  # offset of every candidate

# Figure 5.3: two people come to overlap.
MEETING_SCENE: Final = "leader_swap"
PENALTIES: Final = (10.0, 1.0)
_STREAMS: Final = 6  # random streams of the tracker, all drawn
_BEFORE: Final = 12  # images from the initialisation of both to the drawn image
_HIDDEN: Final = 0.2  # hidden share of a person in the drawn image
_CONTOUR_COLOURS: Final = ("#ffb000", "#00b3ff")

# Figures 4.4 and 7.2: contours with and without people.
CONTOUR_SCENE: Final = "passers_by"
SEED: Final = 100
_EVERY: Final = 5  # interval between images
_IMAGES: Final = 30  # images of each kind, as in the thesis
_PLAIN: Final = 0.9  # minimum visible fraction of a fully visible person
_THRESHOLD_GREY: Final = 22.0  # theta

# Figure 4 of the paper.
SPANS_SCENE: Final = "hall_visits"


CORRECT, SCATTERING, SWAPPING, FETCHING = "a) correct", "b) scattering", "c) swapping", "d) fetching"


def _claims(error: str, frame: int) -> list[tuple[int, int]]:
    """Return the people that candidates are on in a frame, each with the candidate's id."""
    if error == SCATTERING:  # the first person is lost twice, and gets a new track each time
        return [(_FIRST, 10 + frame // 20)] * (frame % 20 < 15) + [(_SECOND, _SECOND)]
    have_met = frame >= _FRAMES // 2
    if error == SWAPPING and have_met:
        return [(_FIRST, _SECOND), (_SECOND, _FIRST)]
    return [(_FIRST, _FIRST), (_FIRST if error == FETCHING and have_met else _SECOND, _SECOND)]


def score_error(name: str) -> Scores:
    """Score the tracks of two crossing people with one kind of error."""
    return evaluate(_true_walks(), _tracks(name), frames=_FRAMES)


def draw_errors() -> Figure:
    """Draw true paths and tracks over time, with the metrics of each error: figure 3.4."""
    page, kinds = canvas(4.6), (CORRECT, SCATTERING, SWAPPING, FETCHING)
    for axes, name in zip(page.subplots(2, 2, sharex=True, sharey=True).flat, kinds, strict=True):
        _draw_walks(axes, name)
    return page


def _draw_walks(axes: Axes, name: str) -> None:
    truth, tracks, scores = _true_walks(), _tracks(name), score_error(name)
    for person in (_FIRST, _SECOND):
        walk = truth.take(truth.id == person)
        axes.plot(walk.frame, _middle(walk.box), color=GREY, linewidth=7, solid_capstyle="butt")
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
    return TrueBoxes.from_rows(
        (frame + 1, person, _place(frame, person), True, 1.0) for frame, person in walks
    )


def _tracks(name: str) -> TrackBoxes:
    claims = [(frame, *claim) for frame in range(_FRAMES) for claim in _claims(name, frame)]
    off = np.array([*_OFF_PX, 0.0, 0.0])
    return TrackBoxes.from_rows(
        (frame + 1, number, _place(frame, person) + off, 1.0) for frame, person, number in claims
    )


TARGETS: Final = np.array([(30.0, 50.0, 50.0, 160.0), (140.0, 60.0, 44.0, 140.0), (240.0, 70.0, 40.0, 120.0)])
CANDIDATES: Final = np.array(
    [(36.0, 58.0, 50.0, 160.0), (144.0, 50.0, 50.0, 140.0), (262.0, 96.0, 40.0, 120.0)]
)
"""Boxes [px] of figure 3.5's one frame: two targets are found, and the third pair shares less than half."""
MATCHES: Final = ((0, 0), (1, 1))


def score_example() -> Scores:
    """Score the one frame of figure 3.5."""
    true = TrueBoxes.from_rows((1, number, box, True, 1.0) for number, box in enumerate(TARGETS, 1))
    found = TrackBoxes.from_rows((1, number, box, 1.0) for number, box in enumerate(CANDIDATES, 1))
    return evaluate(true, found, frames=1)


def draw_example() -> Figure:
    """Draw targets, candidates, intersections of associated boxes, and the metrics: figure 3.5."""
    page = canvas(3.0)
    axes, text = page.subplots(1, 2, width_ratios=(2, 1))
    for boxes, colour, style in ((TARGETS, BLACK, "-"), (CANDIDATES, ORANGE, "--")):
        for box in boxes.tolist():
            frame_box(axes, box, colour, linestyle=style)
    for target, candidate in MATCHES:
        box = shared(TARGETS[target], CANDIDATES[candidate])
        frame_box(axes, box, GREY, hatch="///", linewidth=0)
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
    """Return the intersection (left, top, width, height) of two overlapping boxes (4,)."""
    corner = np.maximum(one[:2], other[:2])
    size = np.minimum(one[:2] + one[2:], other[:2] + other[2:]) - corner
    return float(corner[0]), float(corner[1]), float(size[0]), float(size[1])


@dataclass(frozen=True, slots=True, eq=False)
class Meeting:
    """The images in which two people come to overlap.

    Attributes:
        frames: thermal images with their times, the last of which is drawn.
        boxes: of the two [px] in the first two of these images.
        apart_px: distance between the centres of their true boxes in the last image.
    """

    frames: Sequence[Frame]
    boxes: tuple[Box, Box]
    apart_px: float


def draw_interaction() -> Figure:
    """Draw results of random streams with a strong and a weak penalty on overlap: figure 5.3."""
    meeting = find_meeting()
    page = canvas(3.0)
    for axes, penalty in zip(page.subplots(1, 2), PENALTIES, strict=True):
        _draw_contours(axes, meeting, penalty)
    return page


def find_meeting() -> Meeting:
    """Play the scenario until a person hides a fifth of another one, and return the images before.

    Raises:
        RuntimeError: no person hides another one.
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
    raise RuntimeError(f"no person occludes another in {MEETING_SCENE}")


def contours_after(meeting: Meeting, penalty: float, number: int) -> list[Ellipse]:
    """Track the two with a random stream of the literal tracker, and return the contours at the end."""
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


def thermal_moments() -> Iterator[Moment]:
    """Play the scenario, and yield every fifth thermal image with the truth."""
    return play(load_scenario(CONTOUR_SCENE), SEED, THERMAL, images=(THERMAL,), every=_EVERY)


def _whole(moment: Moment) -> list[PersonTruth]:
    """Return the people who are fully visible."""
    people = [one for one in moment.truth.people if one.visible_px > 0 and one.box is not None]
    return [one for one in people if one.visible_fraction > _PLAIN]


def draw_fitness() -> Figure:
    """Draw histograms of the fitness of prior samples, without and with a person: figure 4.4."""
    moments = list(thermal_moments())
    kinds = {
        "30 images without a person": [
            one for one in moments if not any(person.visible_px > 0 for person in one.truth.people)
        ],
        "30 images with a person": [one for one in moments if _whole(one)],
    }
    page, rng = canvas(2.6), stream(SEED, "reproduce.fitness")
    left, right = page.subplots(1, 2, sharey=True)
    for axes, (title, found) in zip((left, right), kinds.items(), strict=True):
        images = [one.frame.grey(THERMAL) for one in found[:_IMAGES]]
        prior = (THESIS_SINGLE.detector.count, images[0].shape, THESIS_SINGLE.motion, THESIS_SINGLE.detector)
        fits = [fitness_grey(image, draw_prior(*prior, rng)) for image in images]
        axes.hist(np.concatenate(fits), bins=np.arange(-42, 43, 2).tolist(), log=True, color=ORANGE)
        axes.axvline(_THRESHOLD_GREY, color=BLACK, linestyle="--", linewidth=1)
        label(axes, title, "fitness [grey]; dashed: the threshold", "samples")
    return page


def draw_cues() -> Figure:
    """Draw strength, top and bottom of contours over the distance of their people: figure 7.2."""
    rows = [row for moment in thermal_moments() for row in _cues(moment)]
    distance, *cues = np.array(rows).T
    page = canvas(2.6)
    names = ("strength [grey]", "top [row]", "bottom [row]")
    for axes, values, name in zip(page.subplots(1, 3), cues, names, strict=True):
        axes.plot(distance, values, ".", color=ORANGE, markersize=3)
        label(axes, name, "distance [m]")
        if name.endswith("[row]"):
            axes.invert_yaxis()
    return page


def fitness_grey(thermal: NDArray[np.uint8], state: NDArray[np.float32]) -> Floats:
    """Return the fitness (N,) of samples (N, 9) in grey: equation 4.3, with the literal tracker's cap."""
    height, width = thermal.shape
    model = ContourModel.build((height, width), THESIS_SINGLE.contour)
    differences = model.differences(model.prepare(thermal), state).astype(np.float64)
    return np.asarray(differences @ model.weights * THESIS_SINGLE.contour.saturation_grey)


def _cues(moment: Moment) -> Iterator[tuple[float, float, float, float]]:
    """Return distance, strength, top and bottom of the best contour of each fully visible person."""
    rng = stream(SEED, "reproduce.cues")
    for person in _whole(moment):
        assert person.box is not None
        state = draw_around(person.box, THESIS, rng)
        fit = fitness_grey(moment.frame.grey(THERMAL), state)
        best = state[int(fit.argmax())]
        top, bottom = best[Y] - CROWN * best[H], best[Y] + FOOT * best[H]
        yield person.distance_m, float(fit.max()), float(top), float(bottom)


def draw_time_ranges() -> Figure:
    """Draw a line for each person over the images with the person counted and visible: paper, figure 4."""
    seen: dict[str, list[int]] = {}
    for moment in play(load_scenario(SPANS_SCENE), 0, THERMAL):
        for person in moment.truth.people:
            if person.is_counted and person.visible_px > 0:
                seen.setdefault(person.name, []).append(moment.number)
    page, axes = single(0.8 + 0.18 * len(seen))
    for row, frames in enumerate(seen.values(), 1):
        spans = [(frames[run[0]], len(run)) for run in unbroken(frames)]
        axes.broken_barh(spans, (row - 0.35, 0.7), color=BLUE)
    axes.set_yticks(range(1, len(seen) + 1), list(seen))
    label(axes, "", "image")
    return page
