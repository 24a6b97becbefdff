from __future__ import annotations

import threading
from dataclasses import replace
from functools import partial
from typing import get_args

import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.image_files import MOST, BackgroundQueue, about_gains, thermal_span_c
from peopleboy.sim.cameras.camera_config import ColourConfig, GainName, ThermalConfig


def _wait(for_what: threading.Event) -> None:
    for_what.wait(10)


def test_work_is_done_in_order_and_none_is_dropped_however_much_waits() -> None:
    done: list[int] = []
    begins = threading.Event()
    queue = BackgroundQueue()
    queue.add(partial(_wait, begins))
    threading.Timer(0.05, begins.set).start()
    for number in range(3 * MOST):  # which waits until some is done
        queue.add(partial(done.append, number))
    assert begins.is_set()
    queue.flush()
    assert done == list(range(3 * MOST))
    queue.close()


@pytest.mark.parametrize("finds_it", [BackgroundQueue.flush, partial(BackgroundQueue.add, work=lambda: None)])
def test_an_error_is_raised_where_more_is_asked_for(finds_it) -> None:
    def fail() -> None:
        raise BadInput("the disk is full")

    queue, after = BackgroundQueue(), []
    queue.add(fail)
    queue._waiting[0].exception()  # waits for it
    with pytest.raises(BadInput, match="the disk is full"):
        finds_it(queue)
    queue.add(partial(after.append, 1))
    queue.close()
    assert after == [1]


def test_closing_does_what_is_left_and_tells_of_no_error() -> None:
    queue, begins, done = BackgroundQueue(), threading.Event(), []

    def fail() -> None:
        begins.wait(10)
        raise BadInput("the disk is full")

    queue.add(fail)
    queue.add(partial(done.append, 1))
    begins.set()
    queue.close()
    assert done == [1]


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
