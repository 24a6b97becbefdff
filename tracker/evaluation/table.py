"""Scores as rows to print and as a dictionary to store."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.evaluate import Scores
from peopleboy.wording import hint

IF_KNOWN: Final = frozenset(("floor", "latency"))
"""Groups of metrics that not all sequences have."""


@dataclass(frozen=True, slots=True)
class Figure:
    """One metric.

    Attributes:
        name: usual name, unique among the metrics.
        unit: `%`, `m`, `ms`, or empty for a plain number.
        where: path of the metric in `Scores`; its first part is the metric's group.
        meaning: explanation for readers who do not know the name.
    """

    name: str
    unit: str
    where: str
    meaning: str

    @property
    def group(self) -> str:
        """Group of the metric: counts, thesis, paper, mot, sets, floor or latency."""
        return self.where.partition(".")[0]

    @property
    def key(self) -> str:
        """Name in JSON files: without spaces, and with the unit at its end."""
        unit = {"%": "_percent", "m": "_m", "ms": "_ms"}.get(self.unit, "")
        return self.name.replace("95 %", "p95").replace("(2)", "2").replace(" ", "_") + unit

    @property
    def better(self) -> int:
        """1 if a larger value is better, -1 if a smaller one is, 0 if neither."""
        return -1 if self.name in SMALLER_IS_BETTER else 0 if self.name in NEITHER_IS_BETTER else 1

    def is_defined_for(self, scores: Scores) -> bool:
        """Return whether these scores include the data that the metric needs."""
        if self.group in IF_KNOWN:
            return len(getattr(scores, self.group)) > 0
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


FIGURES: tuple[Figure, ...] = (
    Figure("CR", "%", "thesis.cr", "Count recall: share of the people to find that have a matching box."),
    Figure("CP", "%", "thesis.cp", "Count precision: share of all boxes that match a person."),
    Figure("CA", "%", "thesis.ca", "Count accuracy: harmonic mean of CR and CP."),
    Figure("AR", "%", "thesis.ar", "Area recall: share of a person's box that the matching box covers."),
    Figure("AP", "%", "thesis.ap", "Area precision: share of a tracker's box inside the box of its person."),
    Figure("AA", "%", "thesis.aa", "Area accuracy: Dice coefficient of the areas, which combines AR and AP."),
    Figure("OC", "%", "paper.oc", "Overlap coefficient: share of a person's frames that its track covers."),
    Figure(
        "DC", "%", "paper.dc", "Dice coefficient: like OC, but lower if a track continues without its person."
    ),
    Figure("OCR", "%", "paper.ocr", "Object count recall: boxes per person to find, regardless of position."),
    Figure(
        "OCP", "%", "paper.ocp", "Object count precision: people to find per box, regardless of position."
    ),
    Figure("OCA", "%", "paper.oca", "Object count accuracy: harmonic mean of OCR and OCP."),
    Figure("OAR", "%", "paper.oar", "Object area recall: like AR, but without an IoU threshold."),
    Figure("BAP", "%", "paper.bap", "Box area precision: like AP, but without an IoU threshold."),
    Figure("ADC", "%", "paper.adc", "Area Dice coefficient: like AA, but without an IoU threshold."),
    Figure(
        "MOTA",
        "%",
        "mot.clear.mota",
        "100 minus false negatives, false positives and id switches per person.",
    ),
    Figure("MOTP", "%", "mot.clear.motp", "Mean IoU of matched boxes."),
    Figure("FN", "", "mot.clear.misses", "False negatives: people without a box of IoU 0.5 or more."),
    Figure(
        "FP", "", "mot.clear.false_positives", "False positives: boxes without a person of IoU 0.5 or more."
    ),
    Figure(
        "IDSW", "", "mot.clear.switches", "Identity switches: changes of the track id that matches a person."
    ),
    Figure("MT", "", "mot.clear.mostly_tracked", "Mostly tracked: people matched in over 80 % of frames."),
    Figure("ML", "", "mot.clear.mostly_lost", "Mostly lost: people matched in under 20 % of their frames."),
    Figure("Frag", "", "mot.clear.fragments", "Fragmentations: interruptions of a person's matches."),
    Figure(
        "IDF1",
        "%",
        "mot.identity.idf1",
        "Identity F1: harmonic mean of IDP and IDR, over the whole sequence.",
    ),
    Figure(
        "IDP",
        "%",
        "mot.identity.idp",
        "Identity precision: share of boxes on the person assigned to their track.",
    ),
    Figure(
        "IDR", "%", "mot.identity.idr", "Identity recall: share of people with a box of their assigned track."
    ),
    Figure(
        "HOTA",
        "%",
        "mot.hota.hota",
        "Geometric mean of DetA and AssA, averaged over IoU thresholds 0.05 to 0.95.",
    ),
    Figure(
        "DetA", "%", "mot.hota.deta", "Detection accuracy: matches divided by the sum of matches and errors."
    ),
    Figure(
        "AssA", "%", "mot.hota.assa", "Association accuracy: consistency of track ids over matched boxes."
    ),
    Figure("DetRe", "%", "mot.hota.detre", "Detection recall: matches per person to find."),
    Figure("DetPr", "%", "mot.hota.detpr", "Detection precision: matches per box."),
    Figure("AssRe", "%", "mot.hota.assre", "Association recall: share of a person's frames with its track."),
    Figure("AssPr", "%", "mot.hota.asspr", "Association precision: share of a track's boxes on its person."),
    Figure("LocA", "%", "mot.hota.loca", "Localisation accuracy: mean IoU of matched boxes."),
    Figure("OSPA", "", "sets.ospa", "Mean distance of people and boxes in a frame, 0 (equal) to 1."),
    Figure("OSPA(2)", "", "sets.ospa2", "Distance of people's paths and tracks over the sequence, 0 to 1."),
    Figure("mean error", "m", "floor.mean_m", "Mean distance between estimated and true positions."),
    Figure("median error", "m", "floor.median_m", "Median distance between estimated and true positions."),
    Figure(
        "95 % error",
        "m",
        "floor.p95_m",
        "95th percentile of the distance between estimated and true positions.",
    ),
    Figure("NEES", "", "floor.nees", "Normalised estimation error squared; 2 for consistent covariances."),
    Figure(
        "in ellipse",
        "%",
        "floor.inside",
        "Share of matches within the 95 % ellipse of the estimated covariance.",
    ),
    Figure("latency", "ms", "latency.mean_ms", "Mean wall time of an update, after the first second."),
    Figure("95 % latency", "ms", "latency.p95_ms", "95th percentile of the wall time of an update."),
    Figure("frames", "", "counts.frames", "Number of frames, with or without people."),
    Figure("targets", "", "counts.targets", "Number of boxes of people to find."),
    Figure("candidates", "", "counts.candidates", "Number of tracker boxes that are scored."),
    Figure("ignored", "", "counts.ignored", "Number of other tracker boxes, on people who are ignored."),
    Figure("matches", "", "counts.matches", "Number of boxes that match a person, with an IoU above 0.5."),
    Figure("misses", "", "counts.misses", "Number of people to find without a matching box."),
    Figure("false_alarms", "", "counts.false_alarms", "Number of boxes that match no person."),
    Figure("tracks", "", "counts.tracks", "Number of track ids."),
    Figure(
        "true_tracks",
        "",
        "counts.true_tracks",
        "Number of track ids that match a person in at least one frame.",
    ),
    Figure(
        "false_tracks", "", "counts.false_tracks", "Number of track ids that match no person in any frame."
    ),
)

# They depend on boxes elsewhere, which cannot be judged where only one person is annotated.
NEED_EVERYBODY = frozenset(
    (
        *("CP", "CA", "AP", "AA", "OCR", "OCP", "OCA", "BAP", "ADC"),
        *("MOTA", "FP", "IDF1", "IDP", "HOTA", "DetA", "DetPr", "OSPA", "OSPA(2)"),
        *("false_alarms", "false_tracks"),
    )
)


SMALLER_IS_BETTER = frozenset(
    (
        *("FN", "FP", "IDSW", "ML", "Frag", "OSPA", "OSPA(2)", "misses", "false_alarms", "false_tracks"),
        *("mean error", "median error", "95 % error", "latency", "95 % latency"),
    )
)
NEITHER_IS_BETTER = frozenset(("NEES", "in ellipse", "frames", "targets", "candidates", "ignored", "tracks"))


def parse_figures(names: str) -> tuple[Figure, ...]:
    """Return the metrics with these names, separated by commas; capitals do not matter.

    Raises:
        BadInput: a name is unknown or given twice.
    """
    known = {figure.name.lower(): figure for figure in FIGURES}
    chosen: list[Figure] = []
    for name in (part.strip() for part in names.split(",")):
        figure = known.get(name.lower())
        if figure is None:
            raise BadInput(f"unknown metric {name!r}; {hint(name, [each.name for each in FIGURES])}")
        if figure in chosen:
            raise BadInput(f"metric {figure.name!r} is given twice; leave one out")
        chosen.append(figure)
    return tuple(chosen)


def rows(scores: Scores, figures: Sequence[Figure] = FIGURES) -> list[Row]:
    """Return metrics with their values, for a table."""
    return [Row(figure, figure.of(scores)) for figure in figures]


def to_json(scores: Scores, figures: Sequence[Figure] = FIGURES) -> dict[str, dict[str, float | int | None]]:
    """Return metrics by group and key, for JSON: None for undefined."""
    groups: dict[str, dict[str, float | int | None]] = {}
    for row in rows(scores, figures):
        if row.figure.group in IF_KNOWN and not row.figure.is_defined_for(scores):
            continue
        value = None if math.isnan(row.value) else row.value
        groups.setdefault(row.figure.group, {})[row.figure.key] = value
    return groups
