"""Draw the learning curves of `examples.learning.ppo` as one SVG picture.

python -m examples.learning.curves runs/ppo curves.svg
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Final

import click
import matplotlib as mpl
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

COLOURS: Final = {"truth": "#0072b2", "pixels": "#d55e00", "tracks": "#009e73"}
BEST: Final = 30.0  # reward of a perfect episode


def read_curve(file: Path) -> dict[str, list[float]]:
    """Read a learning curve: its columns by name."""
    with file.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def draw_curves(files: list[Path], out: Path) -> None:
    """Draw reward against training steps, one panel per task, one line per file TASK-OBSERVATION-SEED.csv."""
    tasks = list(dict.fromkeys(file.stem.split("-")[0] for file in files))
    mpl.rcParams |= {"svg.hashsalt": "learning", "svg.fonttype": "none"}  # equal curves give equal files
    figure = Figure(figsize=(4.2 * len(tasks), 3.2), layout="constrained")
    FigureCanvasSVG(figure)
    panels = figure.subplots(1, len(tasks), sharey=True, squeeze=False)[0]
    for panel, task in zip(panels, tasks, strict=True):
        for file in files:
            kind, observation, _ = file.stem.split("-")
            if kind != task:
                continue
            curve, colour = read_curve(file), COLOURS[observation]
            label = f"{observation}, {curve['train_cpu_s'][-1]:.0f} s of CPU time"
            panel.plot(curve["steps"], curve["reward"], "o-", ms=3, color=colour, label=label)
            panel.fill_between(curve["steps"], curve["low"], curve["high"], color=colour, alpha=0.2, lw=0)
        panel.axhline(BEST, color="#888888", lw=0.8, ls=":")
        panel.set(title=task, xlabel="training steps")
        panel.grid(alpha=0.25)
        panel.legend(fontsize=8, loc="lower right")
    panels[0].set_ylabel("reward of an episode of 30 s")
    figure.savefig(out, format="svg", metadata={"Date": None})


@click.command()
@click.argument("folder", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
def main(folder: Path, out: Path) -> None:
    """Draw the curves in FOLDER as the picture OUT."""
    files = sorted(folder.glob("*-*-*.csv"))
    if not files:
        raise click.UsageError(
            f"{folder}: no TASK-OBSERVATION-SEED.csv there; train with examples.learning.ppo"
        )
    draw_curves(files, out)


if __name__ == "__main__":
    main()
