from __future__ import annotations

from dataclasses import replace
from typing import get_args

import pytest

from peopleboy.scenarios.run_folder.gains import about_gains, thermal_span_c
from peopleboy.sim.cameras.camera_config import ColourConfig, GainName, ThermalConfig


@pytest.mark.parametrize("gain", get_args(GainName))
def test_a_run_says_all_that_makes_its_grey_and_nothing_of_other_cameras(gain: GainName) -> None:
    config = ThermalConfig(gain=gain, highest_c=40.0)
    told = about_gains({"thermal": config, "colour": ColourConfig()})
    assert list(told) == ["thermal"]
    again = replace(ThermalConfig(), **told["thermal"])
    assert again == (config if gain == "fixed" else replace(config, highest_c=36.0))


def test_only_a_fixed_gain_has_a_span() -> None:
    assert thermal_span_c(ThermalConfig(lowest_c=18.0)) == [18.0, 36.0]
    assert thermal_span_c(ThermalConfig(gain="plateau")) is None
