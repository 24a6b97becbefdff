"""`python -m benchmarks.speed.processors`: check that tracks are the same on a processor of 2008.

Each tracker runs on the same frames in two processes: a normal one, and one in which numpy, OpenCV, OpenBLAS,
the C library and numba use only instructions of an Intel Nehalem, without AVX and fused multiply-add.
"""

import json
import os
import subprocess
import sys
from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

import click

from benchmarks import call
from benchmarks.speed.contour_tracker import SCENARIO
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.frame_cache import film, frames_of, open_film
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import make_tracker

TRACKERS = ("contour", "learned", "thesis", "colour", "thermal", "paper")
# numpy rejects unknown feature names, and those of its own baseline.
OLD = {
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL",
    "OPENCV_CPU_DISABLE": "AVX512-SKX,AVX2,FMA3,FP16,AVX",
    "OPENBLAS_CORETYPE": "Nehalem",
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX2,-AVX,-FMA",
    "NUMBA_CPU_NAME": "nehalem",
    "NUMBA_CPU_FEATURES": "",
}


def first_difference(shot: Path, tracker: str, kernels: Path) -> tuple[int | None, int]:
    """Track a sequence on both; return the first frame that differs, or None, and the number of tracks."""
    here, old = _tracked(shot, tracker, {}), _tracked(shot, tracker, {**OLD, "NUMBA_CACHE_DIR": str(kernels)})
    differing = [number for number, pair in enumerate(zip(here, old, strict=True)) if pair[0] != pair[1]]
    return (differing[0] if differing else None), sum(count for count, _ in here)


def _tracked(shot: Path, tracker: str, environment: dict[str, str]) -> list[list[object]]:
    """Track a sequence in a separate process: return the number of tracks per frame, and their digests."""
    module = "benchmarks.speed.processors"
    command = [sys.executable, "-m", module, "--film", str(shot), "--trackers", tracker]
    done = subprocess.run(
        command, env={**os.environ, **environment}, check=True, stdout=subprocess.PIPE, text=True
    )
    rows: list[list[object]] = json.loads(done.stdout)
    return rows


def _track(frames: Iterable[Frame], name: str) -> list[tuple[int, str]]:
    tracker = make_tracker(name)
    tracks = [tracker.update(frame) for frame in frames]
    rows = [[_row(track) for track in each] for each in tracks]
    return [(len(each), sha256(repr(each).encode()).hexdigest()) for each in rows]


def _row(track: Track) -> tuple[object, ...]:
    return track.id, track.boxes, track.confidence, track.status, track.occluder, track.age_s


@click.command()
@click.option("--trackers", default=",".join(TRACKERS), show_default=True, help="Scenarios, by name.")
@click.option("--film", "shot", type=click.Path(path_type=Path), hidden=True)
def main(trackers: str, shot: Path | None) -> None:
    """Print whether tracks are the same, except for positions on the floor; exit with 1 if they are not."""
    if shot is not None:
        click.echo(json.dumps(_track(frames_of(open_film(shot)), trackers)))
        return
    is_same = True
    with TemporaryDirectory() as folder:
        made = film(load_scenario(SCENARIO), 0, Path(folder))
        for name in trackers.split(","):
            first, count = first_difference(made.folder, name, Path(folder, "kernels"))
            is_same = is_same and first is None
            rows = "the same" if first is None else f"different from frame {first} on"
            click.echo(f"{name}: {rows}, {count} tracks in all frames")
    sys.exit(0 if is_same else 1)


if __name__ == "__main__":
    call(main, "benchmarks.speed.processors")
