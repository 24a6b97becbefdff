"""Scores as rows to print and as a dictionary to store."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter
from statistics import fmean, stdev
from typing import Final

from peopleboy.tracker.evaluation.evaluate import Scores

FLOOR: Final = "floor"


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of the scores.

    Attributes:
        name: its usual name, unique among the figures.
        unit: `%`, `m`, or empty for a plain number.
        where: path of the figure in `Scores`; its first part is the figure's group.
        meaning: what it says, for a reader who does not know the name.
    """

    name: str
    unit: str
    where: str
    meaning: str

    @property
    def group(self) -> str:
        """Family of the figure: counts, thesis, paper, mot or floor."""
        return self.where.partition(".")[0]

    @property
    def key(self) -> str:
        """Name in JSON files: without spaces, and with the unit at its end."""
        unit = {"%": "_percent", "m": "_m"}.get(self.unit, "")
        return self.name.replace("95 %", "p95").replace(" ", "_") + unit

    def is_defined_for(self, scores: Scores) -> bool:
        """Return whether truth and tracks of these scores have what the figure needs."""
        if self.group == FLOOR:
            return len(scores.floor) > 0
        return not (scores.counts.partly_annotated and self.name in NEED_EVERYBODY)

    def of(self, scores: Scores) -> float:
        """Look the figure up; NaN if it is undefined."""
        if not self.is_defined_for(scores):
            return math.nan
        value: float = attrgetter(self.where)(scores)
        return value


@dataclass(frozen=True, slots=True)
class Row:
    """One figure with its value; NaN if undefined."""

    figure: Figure
    value: float


@dataclass(frozen=True, slots=True)
class SpreadRow:
    """One figure over several sequences.

    Attributes:
        figure: what the numbers are about.
        mean: mean over the sequences in which the figure is defined; NaN if there is none.
        sd: their sample standard deviation; NaN if there are fewer than two.
        sequences: in how many sequences it is defined.
    """

    figure: Figure
    mean: float
    sd: float
    sequences: int


FIGURES: tuple[Figure, ...] = (
    Figure("CR", "%", "thesis.cr", "Count recall: of the people to find, how many were found."),
    Figure("CP", "%", "thesis.cp", "Count precision: of the boxes given, how many are on a person."),
    Figure("CA", "%", "thesis.ca", "Count accuracy: recall and precision of the counts in one."),
    Figure("AR", "%", "thesis.ar", "Area recall: how much of a person's box its match covers."),
    Figure("AP", "%", "thesis.ap", "Area precision: how much of a given box is on its person."),
    Figure("AA", "%", "thesis.aa", "Area accuracy: recall and precision of the areas in one."),
    Figure("OC", "%", "paper.oc", "Overlap coefficient: of a person's frames, how many its track has."),
    Figure("DC", "%", "paper.dc", "Dice coefficient: OC that frames beyond the person's own make worse."),
    Figure(
        "OCR", "%", "paper.ocr", "Object count recall: boxes given per person to find, wherever they are."
    ),
    Figure(
        "OCP", "%", "paper.ocp", "Object count precision: people to find per box given, wherever they are."
    ),
    Figure("OCA", "%", "paper.oca", "Object count accuracy: OCR and OCP in one."),
    Figure("OAR", "%", "paper.oar", "Object area recall: AR without the demand that IoU exceeds 0.5."),
    Figure("BAP", "%", "paper.bap", "Box area precision: AP without the demand that IoU exceeds 0.5."),
    Figure("ADC", "%", "paper.adc", "Area Dice coefficient: AA without the demand that IoU exceeds 0.5."),
    Figure(
        "MOTA", "%", "mot.clear.mota", "100 less the misses, false alarms and switches per person to find."
    ),
    Figure("MOTP", "%", "mot.clear.motp", "Mean IoU of the boxes that match."),
    Figure("FN", "", "mot.clear.misses", "People without a box of IoU 0.5 or more."),
    Figure("FP", "", "mot.clear.false_positives", "Boxes without a person at IoU 0.5 or more."),
    Figure("IDSW", "", "mot.clear.switches", "Identity switches: a person's track gets another id."),
    Figure("IDF1", "%", "mot.identity.idf1", "IDP and IDR in one: who is who over the whole sequence."),
    Figure("IDP", "%", "mot.identity.idp", "Of the boxes given, how many are on the person of their track."),
    Figure("IDR", "%", "mot.identity.idr", "Of the people to find, how many have the box of their track."),
    Figure("HOTA", "%", "mot.hota.hota", "DetA and AssA in balance, averaged over IoU 0.05 to 0.95."),
    Figure("DetA", "%", "mot.hota.deta", "Detection accuracy: matches per match, miss or false alarm."),
    Figure(
        "AssA", "%", "mot.hota.assa", "Association accuracy: how constantly matched boxes keep their person."
    ),
    Figure("mean error", "m", "floor.mean_m", "How far off the person a match is said to stand, mean."),
    Figure("median error", "m", "floor.median_m", "The same, which half of the matches do not exceed."),
    Figure("95 % error", "m", "floor.p95_m", "The same, which 95 % of the matches do not exceed."),
    Figure("NEES", "", "floor.nees", "Error squared over its claimed variance; 2 if that is honest."),
    Figure("in ellipse", "%", "floor.inside", "Matches within the 95 % ellipse of the claimed covariance."),
    Figure("frames", "", "counts.frames", "Frames of the sequence, with or without people."),
    Figure("targets", "", "counts.targets", "Boxes of people to find."),
    Figure("candidates", "", "counts.candidates", "Boxes that the tracker gave."),
    Figure("ignored", "", "counts.ignored", "Further boxes that it gave, on people who do not count."),
    Figure("matches", "", "counts.matches", "Boxes that are on a person, with IoU above 0.5."),
    Figure("misses", "", "counts.misses", "People to find without such a box."),
    Figure("false_alarms", "", "counts.false_alarms", "Boxes without such a person."),
    Figure("tracks", "", "counts.tracks", "Track ids."),
    Figure("true_tracks", "", "counts.true_tracks", "Track ids that match a person at some time."),
    Figure("false_tracks", "", "counts.false_tracks", "Track ids that never match anyone."),
)

# They ask whether boxes elsewhere are wrong, which nobody knows where one person alone is annotated.
NEED_EVERYBODY = frozenset(
    (
        *("CP", "CA", "AP", "AA", "OCR", "OCP", "OCA", "BAP", "ADC"),
        *("MOTA", "FP", "IDF1", "IDP", "HOTA", "DetA", "false_alarms", "false_tracks"),
    )
)


def rows(scores: Scores) -> list[Row]:
    """List every figure with its value, for a table."""
    return [Row(figure, figure.of(scores)) for figure in FIGURES]


def spread(sequences: Sequence[Scores]) -> list[SpreadRow]:
    """List every figure with its mean and standard deviation over the sequences."""
    return [_spread_row(figure, [figure.of(scores) for scores in sequences]) for figure in FIGURES]


def to_json(scores: Scores) -> dict[str, dict[str, float | int | None]]:
    """Return the figures by group and key, as JSON can hold them: None for undefined."""
    groups: dict[str, dict[str, float | int | None]] = {}
    for row in rows(scores):
        if row.figure.group == FLOOR and not row.figure.is_defined_for(scores):
            continue
        value = None if math.isnan(row.value) else row.value
        groups.setdefault(row.figure.group, {})[row.figure.key] = value
    return groups


def _spread_row(figure: Figure, values: list[float]) -> SpreadRow:
    defined = [value for value in values if not math.isnan(value)]
    mean = fmean(defined) if defined else math.nan
    sd = stdev(defined) if len(defined) > 1 else math.nan
    return SpreadRow(figure, mean, sd, len(defined))
