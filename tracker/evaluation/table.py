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
    """One metric.

    Attributes:
        name: usual name, unique among the metrics.
        unit: `%`, `m`, or empty for a plain number.
        where: path of the metric in `Scores`; its first part is the metric's group.
        meaning: explanation for readers who do not know the name.
    """

    name: str
    unit: str
    where: str
    meaning: str

    @property
    def group(self) -> str:
        """Group of the metric: counts, thesis, paper, mot or floor."""
        return self.where.partition(".")[0]

    @property
    def key(self) -> str:
        """Name in JSON files: without spaces, and with the unit at its end."""
        unit = {"%": "_percent", "m": "_m"}.get(self.unit, "")
        return self.name.replace("95 %", "p95").replace(" ", "_") + unit

    def is_defined_for(self, scores: Scores) -> bool:
        """Return whether these scores include the data that the metric needs."""
        if self.group == FLOOR:
            return len(scores.floor) > 0
        return not (scores.counts.partly_annotated and self.name in NEED_EVERYBODY)

    def of(self, scores: Scores) -> float:
        """Return the value; NaN if it is undefined."""
        if not self.is_defined_for(scores):
            return math.nan
        value: float = attrgetter(self.where)(scores)
        return value


@dataclass(frozen=True, slots=True)
class Row:
    """One metric with its value; NaN if undefined."""

    figure: Figure
    value: float


@dataclass(frozen=True, slots=True)
class SpreadRow:
    """One metric over several sequences.

    Attributes:
        figure: the metric.
        mean: mean over the sequences in which the metric is defined; NaN if there is none.
        sd: their sample standard deviation; NaN if there are fewer than two.
        sequences: number of sequences in which it is defined.
    """

    figure: Figure
    mean: float
    sd: float
    sequences: int


FIGURES: tuple[Figure, ...] = (
    Figure("CR", "%", "thesis.cr", "Count recall: people found, as a share of the people to find."),
    Figure("CP", "%", "thesis.cp", "Count precision: boxes on a person, as a share of all boxes."),
    Figure("CA", "%", "thesis.ca", "Count accuracy: combines CR and CP."),
    Figure("AR", "%", "thesis.ar", "Area recall: share of a person's box that its match covers."),
    Figure("AP", "%", "thesis.ap", "Area precision: share of a tracker's box that lies on its person."),
    Figure("AA", "%", "thesis.aa", "Area accuracy: combines AR and AP."),
    Figure("OC", "%", "paper.oc", "Overlap coefficient: share of a person's frames that its track covers."),
    Figure("DC", "%", "paper.dc", "Dice coefficient: like OC, penalising frames outside the person's own."),
    Figure("OCR", "%", "paper.ocr", "Object count recall: boxes per person to find, wherever the boxes are."),
    Figure(
        "OCP", "%", "paper.ocp", "Object count precision: people to find per box, wherever the boxes are."
    ),
    Figure("OCA", "%", "paper.oca", "Object count accuracy: combines OCR and OCP."),
    Figure("OAR", "%", "paper.oar", "Object area recall: AR without the IoU threshold of 0.5."),
    Figure("BAP", "%", "paper.bap", "Box area precision: AP without the IoU threshold of 0.5."),
    Figure("ADC", "%", "paper.adc", "Area Dice coefficient: AA without the IoU threshold of 0.5."),
    Figure(
        "MOTA", "%", "mot.clear.mota", "100 minus false negatives, false positives and switches, per person."
    ),
    Figure("MOTP", "%", "mot.clear.motp", "Mean IoU of matched boxes."),
    Figure("FN", "", "mot.clear.misses", "False negatives: people without a box of IoU 0.5."),
    Figure("FP", "", "mot.clear.false_positives", "False positives: boxes without a person of IoU 0.5."),
    Figure("IDSW", "", "mot.clear.switches", "Identity switches: a person's track gets another id."),
    Figure("IDF1", "%", "mot.identity.idf1", "Identity F1: combines IDP and IDR over the whole sequence."),
    Figure("IDP", "%", "mot.identity.idp", "Identity precision: boxes on the person of their track."),
    Figure("IDR", "%", "mot.identity.idr", "Identity recall: people with a box of their track."),
    Figure("HOTA", "%", "mot.hota.hota", "Geometric mean of DetA and AssA, averaged over IoU 0.05 to 0.95."),
    Figure("DetA", "%", "mot.hota.deta", "Detection accuracy: matches per match or error."),
    Figure("AssA", "%", "mot.hota.assa", "Association accuracy: consistency of ids over matched boxes."),
    Figure("mean error", "m", "floor.mean_m", "Mean distance between estimated and true positions."),
    Figure("median error", "m", "floor.median_m", "Median of that distance."),
    Figure("95 % error", "m", "floor.p95_m", "95th percentile of that distance."),
    Figure("NEES", "", "floor.nees", "Normalised estimation error squared; 2 if covariances are consistent."),
    Figure("in ellipse", "%", "floor.inside", "Matches within the 95 % ellipse of the estimated covariance."),
    Figure("frames", "", "counts.frames", "Frames of the sequence, with or without people."),
    Figure("targets", "", "counts.targets", "Boxes of people to find."),
    Figure("candidates", "", "counts.candidates", "Boxes of the tracker that were scored."),
    Figure("ignored", "", "counts.ignored", "Further boxes, on people who do not count."),
    Figure("matches", "", "counts.matches", "Boxes on a person, with IoU above 0.5."),
    Figure("misses", "", "counts.misses", "People to find without such a box."),
    Figure("false_alarms", "", "counts.false_alarms", "Boxes without such a person."),
    Figure("tracks", "", "counts.tracks", "Track ids."),
    Figure("true_tracks", "", "counts.true_tracks", "Track ids that match a person in at least one frame."),
    Figure("false_tracks", "", "counts.false_tracks", "Track ids that match no person in any frame."),
)

# They depend on boxes elsewhere, which cannot be judged where only one person is annotated.
NEED_EVERYBODY = frozenset(
    (
        *("CP", "CA", "AP", "AA", "OCR", "OCP", "OCA", "BAP", "ADC"),
        *("MOTA", "FP", "IDF1", "IDP", "HOTA", "DetA", "false_alarms", "false_tracks"),
    )
)


def rows(scores: Scores) -> list[Row]:
    """Return every metric with its value, for a table."""
    return [Row(figure, figure.of(scores)) for figure in FIGURES]


def spread(sequences: Sequence[Scores]) -> list[SpreadRow]:
    """Return every metric with its mean and standard deviation over the sequences."""
    return [_spread_row(figure, [figure.of(scores) for scores in sequences]) for figure in FIGURES]


def to_json(scores: Scores) -> dict[str, dict[str, float | int | None]]:
    """Return the metrics by group and key, for JSON: None for undefined."""
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
