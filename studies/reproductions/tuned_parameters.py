"""The parameters that the thesis optimised, the values they are given here, and where they are tried."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.studies.reproductions.tracker_settings import BASES, Changes, TrackerSetting

_SINGLE: Final = "passers_by"
_SEVERAL: Final = "hall_visits"


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One of the parameters.

    Attributes:
        name: on the command line.
        says: what it is.
        section: of the thesis that gives its value.
        base: the tracker of that chapter, one of `BASES`.
        scenario: that of the chapter's data set with a standing robot, here with other seeds.
        printed: the value there.
        values: what to change in the tracker for each value; nothing for the printed one.
    """

    name: str
    says: str
    section: str
    base: str
    scenario: str
    printed: str
    values: Mapping[str, Changes]

    def setting(self, value: str) -> TrackerSetting:
        """Return the tracker with this value."""
        return TrackerSetting(self.base, self.values[value])


def _number(
    name: str,
    says: str,
    section: str,
    chapter: str,
    paths: Sequence[str],
    printed: float,
    others: Sequence[float],
) -> Parameter:
    """Take a number whose place in the settings may have another unit: there it is scaled as it is here."""
    base = f"thesis-{chapter}"
    values: dict[str, Changes] = {
        f"{value:g}": ()
        if value == printed
        else tuple((path, _own(base, path) * value / printed) for path in paths)
        for value in sorted([printed, *others])
    }
    return Parameter(
        name=name,
        says=says,
        section=section,
        base=base,
        scenario=_SINGLE if chapter == "single" else _SEVERAL,
        printed=f"{printed:g}",
        values=values,
    )


def _own(base: str, path: str) -> float:
    record, _, name = path.rpartition(".")
    return float(getattr(getattr(BASES[base], record), name))


def _shoulders(weight: float) -> Changes:
    return (("contour.section_weights", (0.18, 0.18, 0.18, weight, weight, 0.16, 0.16)),)


_ALPHA = Parameter(
    name="alpha",
    says="weight of each shoulder; a side has 0.16",
    section="4.4",
    base="thesis-single",
    scenario=_SINGLE,
    printed="0.07",
    values={
        "0": _shoulders(0.0),
        "0.035": _shoulders(0.035),
        "0.07": (),
        "0.14": _shoulders(0.14),
        "0.28": _shoulders(0.28),
    },
)
_NOISE = tuple(f"motion.noise_{name}" for name in "xywhd")
_N_K = Parameter(
    name="n_k",
    says="frames over which the colour model is a mean",
    section="6.3",
    base="thesis-colour",
    scenario=_SEVERAL,
    printed="10",
    values={str(n): (("colour.frames", n),) if n != 10 else () for n in (1, 3, 10, 30, 100)},
)

_ALL = (
    _ALPHA,
    _number(
        "kappa", "slope of the likelihood [1/grey]", "4.4", "single", ("likelihood.slope",), 0.125,
        (0.03, 0.06, 0.25, 0.5),
    ),
    _number(
        "theta", "threshold of the fitness [grey]", "4.4", "single", ("likelihood.threshold",), 22.0,
        (12.0, 17.0, 27.0, 32.0),
    ),
    _number(
        "U", "largest uncertainty [px²]", "4.4", "single", ("life.uncertainty_px2",), 400.0,
        (100.0, 200.0, 800.0, 1600.0),
    ),
    _number("B", "all of B, times", "4.4", "single", _NOISE, 1.0, (0.25, 0.5, 2.0, 4.0)),
    _number(
        "psi_D", "factor on the detector's samples that overlap a person", "5.3", "thermal",
        ("interaction.detector_penalty",), 0.01, (0.0001, 0.001, 0.1, 1.0),
    ),
    _number(
        "rho", "penalty of who overlaps another person", "5.3", "thermal", ("interaction.penalty",), 2.0,
        (0.0, 1.0, 5.0, 10.0),
    ),
    _number(
        "lambda", "sharpness of the colours' likelihood", "6.3", "colour", ("colour.sharpness",), 50.0,
        (5.0, 15.0, 150.0, 500.0),
    ),
    _N_K,
    _number(
        "rho_o", "penalty of who is hidden in part, towards who hides", "7.5", "occlusion",
        ("interaction.occluded_penalty",), 0.5, (0.0, 0.25, 1.0, 2.0),
    ),
)  # fmt: skip

PARAMETERS: Final[Mapping[str, Parameter]] = {one.name: one for one in _ALL}
"""By name, in the thesis's order."""


def chosen_parameters(names: Sequence[str]) -> list[Parameter]:
    """Find parameters by name; all there are if none is named.

    Raises:
        BadInput: there is no such parameter.
    """
    for name in names:
        if name not in PARAMETERS:
            raise BadInput(f"--parameter {name}: must be one of {', '.join(PARAMETERS)}")
    return [one for name, one in PARAMETERS.items() if not names or name in names]
