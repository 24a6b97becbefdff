"""Every table and figure with numbers of the sources."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from peopleboy.bad_input import BadInput
from peopleboy.studies.reproductions.experiments.attention import ATTENTION
from peopleboy.studies.reproductions.experiments.contents import Contents
from peopleboy.studies.reproductions.experiments.distances import DISTANCES, Correlations, FloorPath
from peopleboy.studies.reproductions.experiments.drive_figures import FIGURES
from peopleboy.studies.reproductions.experiments.drive_windows import WINDOWS
from peopleboy.studies.reproductions.experiments.drives import DRIVES
from peopleboy.studies.reproductions.experiments.experiment import Experiment, Line
from peopleboy.studies.reproductions.experiments.learning import BestClassifiers, Learning, Way
from peopleboy.studies.reproductions.experiments.pictures import DEPICTIONS, Depiction
from peopleboy.studies.reproductions.experiments.scene_models import SCENES
from peopleboy.studies.reproductions.experiments.shortfalls import Causes, Delay
from peopleboy.studies.reproductions.experiments.timing import ATTENTION_TIMES, TIMINGS
from peopleboy.studies.reproductions.experiments.tracking import PAPER, THESIS, TrackerTrial, Tracking
from peopleboy.studies.reproductions.experiments.webcams import Angles, Webcams
from peopleboy.studies.reproductions.measuring.readings import AS_READ, READINGS
from peopleboy.studies.reproductions.measuring.tracker_settings import Changes, Setting, Value
from peopleboy.studies.reproductions.measuring.units import Count
from peopleboy.studies.reproductions.measuring.workload import TRAINING
from peopleboy.tracker.contour.occlusion.pair_features import COLOUR, FEATURES, THERMAL

LITERAL, OURS = "literal", "default"
"""The source's tracker, and ours."""

RULES: dict[str, Count] = {
    "": "ignore",
    ", strict": "absent",
    ", strict, own range": "own range",
    ", half in view": "half in view",
}
"""Ways to count, by what they add to a tracker's name."""

SINGLE = ("dataset1", "dataset2")
SEVERAL = ("dataset3", "dataset4")
BOTH, ONE = "both", "one person"


def _per_suite(number: str, suites: tuple[str, ...], literal: str, *, beside_one: bool = False) -> Tracking:
    """Give figures of each data set and of both together, by both rules; beside those of one person."""
    parts = {suite: (suite,) for suite in suites} | {BOTH: suites}
    trials = [trial for name, part in parts.items() for trial in _by_all_rules(name, part, literal)]
    if beside_one:
        trials += _by_all_rules(ONE, SINGLE, "thesis-single")
    return Tracking(number, THESIS, tuple(trials), "bars", THESIS)


def _by_all_rules(group: str, suites: tuple[str, ...], literal: str) -> Iterator[TrackerTrial]:
    for who, base in ((LITERAL, literal), (OURS, "contour")):
        for strictly, rule in RULES.items():
            yield TrackerTrial(Line(group, who + strictly), Setting(base), suites, rule)


def _sweep(
    number: str,
    metrics: tuple[str, ...],
    literal: str,
    suites: tuple[str, ...],
    paths: tuple[str, ...],
    values: dict[str, Value],
    quick: tuple[str, ...],
) -> Tracking:
    """Change one number; `values` gives it by the name that the source has for it."""
    trials = (
        TrackerTrial(
            Line(name, who), Setting(base, tuple((p, value) for p in paths)), suites, "ignore", name in quick
        )
        for name, value in values.items()
        for who, base in ((LITERAL, literal), (OURS, "contour"))
    )
    return Tracking(number, metrics, tuple(trials), "lines", (metrics[-1],))


def _counts(*counts: int) -> dict[str, Value]:
    return {str(count): count for count in counts}


_BOTH_COUNTS = ("person.count", "detector.count")
_BOTH_FRESH = ("person.fresh_share", "detector.fresh_share")
_BOTH_BEST = ("person.estimate_share", "detector.estimate_share")

_SWEEPS = (
    _sweep(
        "figure-4.9a",
        THESIS,
        "thesis-single",
        SINGLE,
        _BOTH_COUNTS,
        _counts(100, 200, 300, 500, 1000, 2000, 5000),
        ("100", "300", "1000"),
    ),
    _sweep(
        "figure-4.9b",
        THESIS,
        "thesis-single",
        SINGLE,
        _BOTH_FRESH,
        {f"{percent} %": percent / 100 for percent in (0, 10, 20, 30, 50, 70, 90)},
        ("0 %", "20 %", "50 %", "90 %"),
    ),
    _sweep(
        "section-5.2",
        THESIS,
        "thesis-thermal",
        SEVERAL,
        ("interaction.penalty",),
        {"0": 0.0, "1": 1.0, "2": 2.0, "10": 10.0},
        ("0", "2", "10"),
    ),
    _sweep(
        "figure-5.5a",
        THESIS,
        "thesis-thermal",
        SEVERAL,
        ("person.count",),
        _counts(100, 200, 300, 500, 1000, 2000),
        ("100", "200", "1000"),
    ),
    _sweep(
        "figure-5.5b",
        THESIS,
        "thesis-thermal",
        SEVERAL,
        ("interaction.total_count",),
        _counts(200, 300, 500, 1000, 2000),
        ("200", "500", "1000"),
    ),
    _sweep(
        "figure-5.6",
        THESIS,
        "thesis-thermal",
        SEVERAL,
        ("detector.count",),
        _counts(100, 200, 300, 500, 1000, 2000),
        ("100", "500", "1000"),
    ),
    _sweep(
        "paper-table-1",
        PAPER,
        "paper-single",
        SINGLE,
        _BOTH_COUNTS,
        _counts(100, 200, 300, 500, 1000, 2000, 5000),
        ("100", "300", "1000"),
    ),
    _sweep(
        "paper-table-2",
        PAPER,
        "paper-single",
        SINGLE,
        _BOTH_FRESH,
        # The table gives the share that is resampled.
        {f"{percent} %": round(1 - percent / 100, 2) for percent in (95, 90, 85, 80, 70, 60, 50)},
        ("90 %", "50 %"),
    ),
    _sweep(
        "paper-table-3",
        PAPER,
        "paper-single",
        SINGLE,
        _BOTH_BEST,
        {f"{percent} %": percent / 100 for percent in (5, 10, 15, 20, 30, 40, 50)},
        ("5 %", "30 %", "50 %"),
    ),
)

_STEPS = {"thermal": "thermal", "thermal + colour": "colour", "thermal + colour + occlusions": "occlusion"}


def _chapters(number: str, groups: Iterable[str]) -> Tracking:
    """Compare thermal alone, with colour, and with occlusion handling."""
    trials = (
        TrackerTrial(Line(group, who), Setting(base), SEVERAL)
        for group in groups
        for who, base in ((LITERAL, f"thesis-{_STEPS[group]}"), (OURS, _ours(_STEPS[group])))
    )
    return Tracking(number, THESIS, tuple(trials), "bars", THESIS)


def _ours(step: str) -> str:
    return "contour" if step == "occlusion" else f"contour-{step}"


_SURE = (("life.birth_confidence", 0.0), ("search.clear_confidence", -0.15), ("search.small_confidence", 0.1))
"""What the default has to be sure of before it tells of somebody, and how far the three are apart."""


def _frontier() -> Tracking:
    """Let the default be more or less sure before it tells of somebody, with thermal images alone and all."""
    values = (0.3, 0.45, 0.6, 0.75, 0.9)
    trials = (
        TrackerTrial(
            Line(f"{value:g}", who),
            Setting(base, tuple((path, value + more) for path, more in _SURE)),
            SEVERAL,
            is_quick=value >= values[2],
        )
        for value in values
        for who, base in ((f"{OURS}, thermal", "contour-thermal"), (OURS, "contour"))
    )
    return Tracking("section-7.5", THESIS, tuple(trials), "lines", ("AA",))


def _colours(
    number: str, kinds: dict[str, Changes | None], slow: tuple[str, ...], quick_changes: Changes = ()
) -> Tracking:
    """Compare ways to describe colours; None is no colour at all."""
    trials = (
        TrackerTrial(
            Line(name, who),
            Setting(thermal) if changes is None else Setting(colour, changes),
            SEVERAL,
            "ignore",
            name not in slow,
            quick_changes,
        )
        for name, changes in kinds.items()
        for who, thermal, colour in (
            (LITERAL, "thesis-thermal", "thesis-colour"),
            (OURS, "contour-thermal", "contour-moments"),
        )
    )
    return Tracking(number, THESIS, tuple(trials), "bars", ("CA", "AA"))


def _histogram(space: str) -> Changes:
    return (("colour.representation", "histogram"), ("colour.space", space))


_REPRESENTATIONS: dict[str, Changes | None] = {
    "no colour": None,
    "1 moment": (("colour.representation", "moments1"),),
    "2 moments": (("colour.representation", "moments2"),),
    "3 moments": (("colour.representation", "moments3"),),
    "histogram": _histogram("rgb"),
}
_SPACES: dict[str, Changes | None] = {
    "no colour": None,
    "grey": _histogram("grey"),
    "RGB": _histogram("rgb"),
    "HSV": _histogram("hsv"),
}


def _paper_figure_5() -> Tracking:
    several = _by_all_rules("several persons", SEVERAL, "paper-several")
    one = _by_all_rules(ONE, SINGLE, "paper-single")
    return Tracking("paper-figure-5", PAPER, (*several, *one), "bars", PAPER)


def _readings() -> Tracking:
    """Undo each reading of what the thesis leaves open: one person, where they were chosen and where not."""
    trials = (
        TrackerTrial(Line(name, who), Setting("thesis-single", changes), (suite,), is_quick=name in _FEW)
        for name, changes in READINGS.items()
        for who, suite in ((LITERAL, SINGLE[0]), (f"{LITERAL}, {TRAINING}", TRAINING))
    )
    return Tracking("section-4.2", ("OC", "CR", "CP", "AA"), tuple(trials), "none")


_FEW = (AS_READ, "contrast in full", "points 2 px from the contour")

_TABLE_7_1 = (Way("thermal", THERMAL), Way("colour", COLOUR), Way("both"))
_TABLE_7_2 = (Way("single", most=1), Way("weighted pairs"), Way("weighted triplets", most=3))
_TABLE_7_3 = tuple(Way(name, (name,), 1) for name in FEATURES)

_ALL: tuple[Experiment, ...] = (
    Contents(),
    Depiction("figure-3.4"),
    Depiction("figure-3.5"),
    _readings(),
    Depiction("figure-4.4"),
    _per_suite("figure-4.8", SINGLE, "thesis-single"),
    *_SWEEPS[:2],
    *TIMINGS[:2],
    Depiction("figure-5.3"),
    _SWEEPS[2],
    _per_suite("figure-5.4", SEVERAL, "thesis-thermal", beside_one=True),
    *_SWEEPS[3:6],
    Delay(SINGLE, {LITERAL: Setting("thesis-single"), OURS: Setting("contour")}),
    TIMINGS[2],
    _chapters("figure-6.4", list(_STEPS)[:2]),
    _colours("figure-6.5", _REPRESENTATIONS, ("histogram",)),
    # A histogram takes so long that few samples have to do when there is little time.
    _colours("figure-6.6", _SPACES, (), (("person.count", 200),)),
    *TIMINGS[3:],
    Depiction("figure-7.2"),
    Learning("table-7.1", _TABLE_7_1),
    Learning("table-7.2", _TABLE_7_2),
    Learning("table-7.3", _TABLE_7_3),
    BestClassifiers(),
    _chapters("figure-7.3", _STEPS),
    _frontier(),
    Causes(OURS, Setting("contour"), {"several persons": SEVERAL, ONE: SINGLE}),
    *_SWEEPS[6:],
    Depiction("paper-figure-4"),
    _paper_figure_5(),
    *DEPICTIONS[:2],
    Webcams(),
    *DEPICTIONS[2:4],
    Angles(),
    Correlations(),
    *DISTANCES,
    FloorPath(),
    *SCENES,
    *DRIVES,
    *WINDOWS,
    *FIGURES,
    *ATTENTION,
    ATTENTION_TIMES,
    *DEPICTIONS[4:],
)

EXPERIMENTS: dict[str, Experiment] = {experiment.id: experiment for experiment in _ALL}
"""By id, in the order of the page."""


PAPERS: Mapping[str, str] = {
    "thesis": "",
    "2005": "paper-",
    "panoramic": "panoramic-",
    "situation": "situation-",
}
"""The sources by name, and how the ids of each begin; those of the thesis are plain."""


def of_paper(paper: str) -> dict[str, Experiment]:
    """Give one source's experiments by id.

    Raises:
        BadInput: there is no such source.
    """
    if paper not in PAPERS:
        raise BadInput(f"unknown paper {paper!r}; there are: {', '.join(PAPERS)}")
    return {number: one for number, one in EXPERIMENTS.items() if paper_of(number) == paper}


def choose(names: Sequence[str], paper: str | None = None) -> list[Experiment]:
    """Find experiments by id or by number: "4.9" is figures 4.9a and 4.9b, "paper" all of 2005.

    Args:
        names: ids or numbers; all there are if left out.
        paper: one of `PAPERS`, to which they are limited.

    Raises:
        BadInput: nothing has this name.
    """
    among = EXPERIMENTS if paper is None else of_paper(paper)
    if not names:
        return list(among.values())
    chosen = {number for name in names for number in _matching(name, among)}
    return [experiment for number, experiment in among.items() if number in chosen]


def _matching(name: str, among: Mapping[str, Experiment]) -> list[str]:
    found = [number for number in among if _is_called(number, name.lower())]
    if not found:
        raise BadInput(f"nothing is called {name!r}; choose from {', '.join(among)}")
    return found


def _is_called(number: str, name: str) -> bool:
    last = number.rsplit("-", 1)[-1]
    names = [number, number.rstrip("ab"), number.split("-")[0]]
    if paper_of(number) == "thesis":
        names += [last, last.rstrip("ab")]
    return name in names


def paper_of(number: str) -> str:
    """Name the source, one of `PAPERS`, that an experiment is from, by its id."""
    begins = (paper for paper, start in PAPERS.items() if start and number.startswith(start))
    return next(begins, "thesis")
