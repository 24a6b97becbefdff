from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.reliability.kills import kill_often
from benchmarks.reliability.soak import MOST_GROWTH_MB, UsageLog, soak_environments, soak_run


@pytest.mark.slow
def test_a_run_that_is_killed_twice_is_whole_each_time_after_it_is_run_again(tmp_path: Path) -> None:
    result = kill_often("run", 2, tmp_path, np.random.default_rng(0))
    assert result.faults == []


@pytest.mark.slow
def test_a_minute_and_a_hundred_environments_need_no_more_memory() -> None:
    log = UsageLog(300)
    soak_run("single_stationary", 1.0 / 60.0, log)
    assert log.growth_mb < MOST_GROWTH_MB
    environments = UsageLog(10)
    soak_environments(100, environments)
    assert environments.growth_mb < MOST_GROWTH_MB
    assert environments.rows[-1].descriptors <= environments.rows[0].descriptors + 2
