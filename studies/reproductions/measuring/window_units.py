"""Units of work of the thesis on situation awareness: windows that show people, or do not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.evaluations.sliding_windows import compare_windows
from peopleboy.studies.training.window_learning.teach_windows import scores_of
from peopleboy.studies.training.window_learning.window_examples import collect_windows
from peopleboy.tracker.rgbd.verification.window_model import people_detector, shipped_windows
from peopleboy.tracker.rgbd.verification.windows import Range

OWN, COLOUR, OPENCV = "own machine", "own machine, colour alone", "OpenCV's detector"
NEAR, FAR = str(Range.NEAR), str(Range.FAR)
MACHINES: Final = ((FAR, OWN), (FAR, COLOUR), (FAR, OPENCV), (NEAR, OWN), (NEAR, COLOUR))
"""Ranges, and who judges windows there."""


@dataclass(frozen=True, slots=True)
class SlideUnit:
    """Look for people in the same images by sliding windows, and by their size in depth.

    Attributes:
        scenarios: played with seed 0.
        most_s: [s] after which films are cut.
        every: so-manieth image is looked at.
    """

    scenarios: tuple[str, ...]
    most_s: float
    every: int
    is_timing: bool = True

    @property
    def key(self) -> str:
        """Films, and which images of them."""
        return f"slide {', '.join(self.scenarios)} {self.most_s:g}s every {self.every}"

    def run(self) -> Result:
        """Look."""
        scenarios = [load_scenario(name) for name in self.scenarios]
        drives = [(one.lasting(min(one.duration_s, self.most_s)), 0) for one in scenarios]
        return compare_windows(drives, self.every)


@dataclass(frozen=True, slots=True)
class WindowUnit:
    """Collect windows of a scenario that nobody learned from, and let machines judge them."""

    scenario: str
    seed: int
    is_timing: bool = False

    @property
    def key(self) -> str:
        """The film."""
        return f"windows {self.scenario}-{self.seed}"

    def run(self) -> Result:
        """Give the scores of people and of all else by range and machine."""
        examples = collect_windows(load_scenario(self.scenario), self.seed, has_jitter=False)
        models = {
            OWN: shipped_windows(sees_depth=True),
            COLOUR: shipped_windows(sees_depth=False),
            OPENCV: people_detector(),
        }
        result: Result = {}
        for kind, who in MACHINES:
            scores = scores_of(models[who], examples, Range(kind)).round(3)
            is_person = examples.is_person[Range(kind)]
            people, others = scores[is_person].tolist(), scores[~is_person].tolist()
            result[f"{kind} {who}"] = {"people": people, "others": others}
        return result
