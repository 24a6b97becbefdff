"""Tracking quality in footage of unknown temperatures: `python -m benchmarks.footage`.

Scenes of the library are rendered, and their 16-bit images are tracked like foreign footage: without a
temperature scale and without the robot's motion. In a hot room clothes are colder than the walls.
`--clips DIR` evaluates on real clips instead, compared with OpenCV's HOG with ByteTrack.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import click

from benchmarks import call
from benchmarks.footage.altered_clips import ALTERATIONS
from benchmarks.footage.compare_clips import compare_clips
from benchmarks.footage.library_footage import show_rooms
from benchmarks.footage.real_clips import PEERS
from peopleboy.tracker.trackers import DEFAULT_TRACKER

_FOLDER: Final = click.Path(exists=True, file_okay=False, path_type=Path)

_NONE: Final = "none"
"""Name of no peer."""
_ALL: Final = "all"
"""Name of all alterations."""


@click.command()
@click.option(
    "--clips", type=_FOLDER, help="Folder of clips, NAME/thermal and NAME/gt.txt, or images with truth."
)
@click.option(
    "--tracker",
    "trackers",
    multiple=True,
    default=(DEFAULT_TRACKER,),
    show_default=True,
    help="Tracker to evaluate on --clips; may be repeated.",
)
@click.option(
    "--peer",
    "peers",
    multiple=True,
    type=click.Choice((*PEERS, _NONE)),
    default=[name for name in PEERS if name.startswith("HOG")],
    help="Peer to evaluate on --clips; may be repeated.  [default: HOG]",
)
@click.option("--only", multiple=True, help="Name of a clip to use; may be repeated.")
@click.option("--frames", type=click.IntRange(min=1), help="Number of frames to use of each clip.")
@click.option(
    "--rate-hz", type=click.FloatRange(min=0.1), help="Frame rate.  [default: as `peopleboy track`]"
)
@click.option(
    "--altered",
    "alterations",
    multiple=True,
    type=click.Choice((*ALTERATIONS, _ALL)),
    help="Also evaluate on --clips altered like this, for robustness; may be repeated.",
)
@click.option(
    "--real-training",
    is_flag=True,
    help="Also evaluate on each of --clips the detector with networks that are fine-tuned on all others.",
)
@click.option("--seeds", type=click.IntRange(min=1), default=1, show_default=True, help="Seeds per tracker.")
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Number of processes.")
def main(clips: Path | None, peers: Sequence[str], alterations: Sequence[str], **how: Any) -> None:
    """Print metrics of the default tracker in library scenes, or of trackers and peers on clips.

    Metrics are in percent. AP and AP50 are average precisions of the detections, by COCO's rules; people are
    small below 48 px, and large from 96 px on. Those of --clips are also written to runs/clips.json.
    """
    if clips is not None:
        compare_clips(
            clips,
            peers=[peer for peer in peers if peer != _NONE],
            alterations=tuple(ALTERATIONS) if _ALL in alterations else alterations,
            **how,
        )
        return
    show_rooms()


if __name__ == "__main__":
    call(main, "benchmarks.footage")
