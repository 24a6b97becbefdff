"""Show the tracks of a camera in rerun's viewer while they are made, without storing them."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import rerun as rr
import rerun.blueprint as rrb

from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.recording.live_picture import live_stream
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Track, confirmed

_QUALITY = 75  # JPEG quality
_CAMERA, _TRACKS = "camera", "camera/tracks"

ShowTracks = Callable[[int, Frame, Sequence[Track]], bool]


@contextmanager
def live_tracks(say: Callable[[str], None], camera: str) -> Iterator[ShowTracks]:
    """Open a viewer, a window or, without a display, a page; yield a function that shows a frame.

    Args:
        say: called with the page's address.
        camera: name of the camera whose image is shown.

    Raises:
        BadInput: the viewer fails.
    """
    with live_stream(say, _lay_out()) as stream:

        def show(number: int, frame: Frame, tracks: Sequence[Track]) -> bool:
            found = list(confirmed(tracks, camera))
            stream.set_time("time", duration=frame.time_s)
            stream.set_time("frame", sequence=number)
            stream.log(_CAMERA, rr.Image(frame.images[camera]).compress(_QUALITY))
            stream.log(
                _TRACKS,
                rr.Boxes2D(
                    array=[box for _, box in found],
                    array_format=rr.Box2DFormat.XYWH,
                    labels=[str(track.id) for track, _ in found],
                    colors=[track_colour(track.id) for track, _ in found],
                ),
            )
            return False

        yield show


def _lay_out() -> rrb.Blueprint:
    return rrb.Blueprint(
        rrb.Spatial2DView(origin=_CAMERA, name="Camera with tracks"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="time", play_state="following"),
    )
