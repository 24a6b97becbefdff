"""Plans for the gallery: `python -m docs.generate.pictures.front.gallery [SCENARIO...]` draws them."""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from peopleboy.scenarios.drawing.draw_plan import draw_plan
from peopleboy.scenarios.files.library import library
from peopleboy.scenarios.files.load import load_scenario

FOLDER = Path(__file__).parents[3] / "pictures" / "gallery"
HEAD_PX, FOOT_PX, SIDE_PX = 110, 192, 140  # title, legend and colour bar, which the page explains
WIDTH_PX, QUALITY = 640, 72


def thumbnail(scenario: str) -> Image.Image:
    """Draw the plan of a scenario without title, legend and colour bar."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "plan.png"
        draw_plan(load_scenario(scenario), 0, path)
        plan = Image.open(path).convert("RGB")
    plan = plan.crop((0, HEAD_PX, plan.width - SIDE_PX, plan.height - FOOT_PX))
    height = round(plan.height * WIDTH_PX / plan.width)
    return plan.resize((WIDTH_PX, height), Image.Resampling.LANCZOS)


def main() -> None:
    """Draw the plans of the scenarios that are named, or of the whole library."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[1:] or library():
        path = FOLDER / f"{name}.webp"
        thumbnail(name).save(path, quality=QUALITY, method=6)
        print(path)


if __name__ == "__main__":
    main()
