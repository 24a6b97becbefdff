"""Pictures from the output of commands."""

from __future__ import annotations

import re
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from docs.generate.pictures.moments import CROSSING
from peopleboy.scenarios.drawing.draw_plan import draw_plan
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions

WIDTH_PX = 1100
TUTORIAL = Path(__file__).parents[3] / "tutorial" / "own-scenario.md"


def first_run() -> Image.Image:
    """Draw the upper third of a contact sheet: its first row of moments."""
    name, seed = CROSSING
    with TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        run(load_scenario(name), RunOptions(seed=seed, out=out, record=False), lambda *_: None)
        sheet = Image.open(out / "contact_sheet.png")
        upper = sheet.crop((0, 0, sheet.width, round(0.355 * sheet.height)))
    return upper.resize((WIDTH_PX, round(upper.height * WIDTH_PX / upper.width)), Image.Resampling.LANCZOS)


def my_scene() -> Image.Image:
    """Draw the plan of the tutorial's scenario."""
    text = TUTORIAL.read_text(encoding="utf-8")
    blocks = re.findall(r'```yaml title="my_scene.yaml"\n(.*?)^```', text, re.DOTALL | re.MULTILINE)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "my_scene.yaml"
        path.write_text(blocks[0], encoding="utf-8")
        draw_plan(load_scenario(path), 0, Path(folder) / "plan.png")
        plan = Image.open(Path(folder) / "plan.png").convert("RGB")
    plan.thumbnail((WIDTH_PX, WIDTH_PX))
    return plan
