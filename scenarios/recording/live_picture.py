"""Show pictures in rerun's viewer while they are made, without storing them."""

import uuid
import weakref
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from peopleboy.scenarios.recording.rows import APPLICATION
from peopleboy.scenarios.recording.viewer import live_viewer

_QUALITY = 75  # JPEG quality
_SCENE, _REWARD, _EPISODES = "scene", "reward", "episodes"


@contextmanager
def live_stream(say: Callable[[str], None], layout: rrb.Blueprint) -> Iterator[rr.RecordingStream]:
    """Open a viewer, a window or, without a display, a page; yield the stream that it shows.

    Args:
        say: called with the page's address.
        layout: of the viewer.

    Raises:
        BadInput: the viewer fails.
    """
    with live_viewer(say, is_left_open=False) as source:
        stream = rr.RecordingStream(APPLICATION, recording_id=uuid.uuid4())
        stream.set_sinks(rr.GrpcSink(source), default_blueprint=layout)
        try:
            yield stream
        finally:
            stream.disconnect()


class LivePicture:
    """A viewer that shows an environment: a window, or a page if there is no screen.

    The viewer ends when it is closed, or with the program. Time continues from one episode to the next, so
    that you can go back to earlier ones.

    Args:
        say: called with the page's address.

    Raises:
        BadInput: the viewer fails.
    """

    def __init__(self, say: Callable[[str], None]) -> None:
        self._time_s = 0.0
        self._earned = 0.0
        with ExitStack() as stack:
            self._stream = stack.enter_context(live_stream(say, _lay_out()))
            self._end = weakref.finalize(self, stack.pop_all().close)

    def begin(self, picture: NDArray[np.uint8], words: str) -> None:
        """Show an episode's first picture, (H, W, 3), and its number."""
        self._earned = 0.0
        self._show(picture)
        self._stream.log(_EPISODES, rr.TextLog(words))

    def go_on(self, picture: NDArray[np.uint8], reward: float, dt_s: float) -> None:
        """Show the next picture, (H, W, 3), dt_s [s] after the last one, with the reward since then."""
        self._time_s += dt_s
        self._earned += reward
        self._show(picture)

    def close(self) -> None:
        """Close the viewer; further calls do nothing."""
        self._end()

    def _show(self, picture: NDArray[np.uint8]) -> None:
        self._stream.set_time("time", duration=self._time_s)
        self._stream.log(_SCENE, rr.Image(picture).compress(_QUALITY))
        self._stream.log(_REWARD, rr.Scalars(self._earned))


def _lay_out() -> rrb.Blueprint:
    below = rrb.Horizontal(
        rrb.TimeSeriesView(origin=_REWARD, name="Reward of the episode so far"),
        rrb.TextLogView(origin=_EPISODES, name="Episodes"),
    )
    above = rrb.Spatial2DView(origin=_SCENE, name="Thermal image with tracks, colour image, plan")
    return rrb.Blueprint(
        rrb.Vertical(above, below, row_shares=[2.0, 1.0]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="time", play_state="following"),
    )
