from __future__ import annotations

import math
from dataclasses import MISSING, dataclass
from typing import Annotated, Literal

import pytest
from pydantic import Field

from peopleboy.settings import IN_DEGREES, check_limits, settings_of, unit_of
from tests.helpers.calls.refused import refused


@dataclass(frozen=True, slots=True, kw_only=True)
class Tripod:
    height_m: Annotated[float, Field(ge=0.5, le=2.0, description="from the floor up")]
    pitch_rad: Annotated[float, IN_DEGREES, Field(ge=-90.0, lt=90.0, description="tilt")] = math.radians(12.0)
    head: Annotated[Literal["ball", "pan"], Field(description="what turns")] = "ball"
    load_kg: Annotated[float | None, Field(gt=0.0, alias="carries_kg", description="at most")] = None

    def __post_init__(self) -> None:
        check_limits(self)


def test_a_setting_has_its_unit_limits_default_and_meaning() -> None:
    height, pitch, head, load = settings_of(Tripod)
    assert (height.key, height.unit, height.default, height.is_required) == ("height_m", "m", MISSING, True)
    assert height.meaning == "from the floor up"
    assert (pitch.field, pitch.key, pitch.unit, pitch.default) == ("pitch_rad", "pitch_deg", "deg", 12.0)
    assert (head.choices, head.default) == (("ball", "pan"), "ball")
    assert (load.key, load.kind, load.can_be_none, load.default) == ("carries_kg", float, True, None)


@pytest.mark.parametrize(
    ("given", "names"),
    [
        ({"height_m": 2.1}, ("height_m: must be at most 2, got 2.1",)),
        ({"height_m": math.nan}, ("height_m: must be at least 0.5, got nan",)),
        ({"pitch_rad": math.radians(90.0)}, ("pitch_deg: must be less than 90, got 90.0",)),
        ({"head": "bal"}, ("head: unknown head 'bal'", "ball, pan")),
        ({"load_kg": 0.0}, ("carries_kg: must be greater than 0, got 0.0",)),
    ],
    ids=lambda given: next(iter(given)) if isinstance(given, dict) else "",
)
def test_a_value_beyond_its_limits_is_refused(given: dict[str, float], names: tuple[str, ...]) -> None:
    with refused(*names):
        Tripod(**{"height_m": 1.0} | given)  # type: ignore[arg-type]


def test_the_limits_themselves_are_within() -> None:
    assert Tripod(height_m=0.5, pitch_rad=math.radians(-90.0)).height_m == 0.5


def test_the_longest_ending_is_the_unit() -> None:
    assert [unit_of(key) for key in ("turn_deg_s", "speed_m_s", "pause_s", "drift_k_per_min", "name")] == [
        "deg/s", "m/s", "s", "K/min", "",
    ]  # fmt: skip
