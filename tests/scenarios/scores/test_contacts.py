from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.scenarios.scores.contacts import count_contacts
from peopleboy.sim.truth.events import EventLog


@given(flags=st.lists(st.booleans(), min_size=1, max_size=40), rate_hz=st.sampled_from([2.0, 15.0, 60.0]))
def test_as_many_contacts_are_counted_as_the_log_tells_of_one_wall(flags: list[bool], rate_hz: float) -> None:
    time_s, log, begun = 1.0 + np.arange(len(flags)) / rate_hz, EventLog(), 0
    for at_s, is_touching in zip(time_s.tolist(), flags, strict=True):
        told = log.update(SimpleNamespace(time_s=at_s, people=(), contacts=("wall",) * is_touching))
        begun += sum(event.kind == "contact starts" for event in told)
    assert count_contacts(time_s, np.array(flags)) == begun


@pytest.mark.parametrize(("touched_s", "count"), [([], 0), ([0.0, 0.1, 0.3], 1), ([0.0, 0.5, 2.0], 3)])
def test_who_bounces_touches_once(touched_s: list[float], count: int) -> None:
    time_s = np.arange(30) / 10.0
    assert count_contacts(time_s, np.isin(time_s, touched_s)) == count
