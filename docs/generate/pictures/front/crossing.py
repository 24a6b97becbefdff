"""Animation of a crossing: `python -m docs.generate.pictures.front.crossing` draws it."""

from __future__ import annotations

import io
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

from docs.generate.pictures.front.overview import crossing, draw_plan, draw_truth
from docs.generate.pictures.moments import ticks
from docs.generate.pictures.paper import panels, show
from peopleboy.scenarios.drawing.overlay import draw_tracks, enlarge, show_thermal
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.sim.world_config import CONTROL_HZ
from peopleboy.tracker.trackers import DEFAULT_TRACKER

PATH = Path(__file__).parents[3] / "pictures" / "crossing.webp"
SEED, FROM_S, UNTIL_S = 0, 2.4, 10.4
EVERY = 2  # ticks per frame: 7.5 frames per second, real time
SCALE = 2
HEIGHT_IN, DPI = 3.1, 100
QUALITY = 65  # of WebP, 0 to 100; lower values blur lines and labels
TITLES = ("thermal image with tracks", "ground truth: visible fraction", "plan: who occludes whom")


def frames() -> Iterator[Image.Image]:
    """Run the crossing, and draw every second tick."""
    scenario = crossing()
    first, last = (round(time_s * CONTROL_HZ) for time_s in (FROM_S, UNTIL_S))
    for _, tick in islice(ticks(scenario, SEED, last, DEFAULT_TRACKER), first, None, EVERY):
        yield _raster(_draw(scenario, tick))


def _draw(scenario: Scenario, tick: Tick) -> Figure:
    figure, (thermal, truth, plan) = panels(TITLES, HEIGHT_IN)
    image = enlarge(show_thermal(tick.observation.images["thermal_scene"]), SCALE)
    show(thermal, draw_tracks(image, tick.tracks, SCALE, tick.explanation))
    draw_truth(truth, tick.truth)
    draw_plan(plan, scenario, tick)
    return figure


def _raster(figure: Figure) -> Image.Image:
    file = io.BytesIO()
    figure.savefig(file, dpi=DPI, facecolor="white")
    return Image.open(file).convert("RGB")


def main() -> None:
    """Write the animation."""
    first, *others = frames()
    first.save(
        PATH,
        save_all=True,
        append_images=others,
        duration=round(1000 * EVERY / 15),
        loop=0,
        quality=QUALITY,
        method=6,
    )
    print(PATH, f"{PATH.stat().st_size / 1e6:.2f} MB, {len(others) + 1} frames")


if __name__ == "__main__":
    main()
