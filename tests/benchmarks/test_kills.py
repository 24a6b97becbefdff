"""Short forms of `make kill-tests` and `make soak`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.reliability.kills import kill_often
from benchmarks.reliability.soak import MOST_GROWTH_MB, UsageLog, soak_environments, soak_run


@pytest.mark.thorough
def test_a_run_that_is_killed_is_whole_after_it_is_run_again(tmp_path: Path) -> None:
    result = kill_often("run", 1, tmp_path, np.random.default_rng(0))
    assert result.faults == []


@pytest.mark.thorough
def test_half_a_minute_and_forty_environments_need_no_more_memory() -> None:
    log = UsageLog(150)
    soak_run(1.0 / 120.0, "detection", log)
    assert log.growth_mb < MOST_GROWTH_MB
    environments = UsageLog(4)
    soak_environments(40, environments)
    assert environments.growth_mb < MOST_GROWTH_MB
    assert environments.rows[-1].descriptors <= environments.rows[0].descriptors + 2
