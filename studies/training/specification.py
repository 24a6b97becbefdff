"""Training specifications of the learned models, and the procedure that trains each of them."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any, ClassVar, Final, Generic, TypeVar, cast

from rich.console import Console

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.atomic_output import atomic, writing_to
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.training.samples import Tasks, collect_missing
from peopleboy.tracker.networks.weights_archive import SHIPPED

MODELS: Final[Mapping[str, tuple[str, str]]] = {
    "cascade": (
        "detector.train_cascade:CascadeTraining",
        "Train the boosted trees that detect people in windows of thermal images.",
    ),
    "people": (
        "detector.train_people:PeopleTraining",
        "Train the network that detects people of all postures in thermal images.",
    ),
    "rescoring": (
        "detector.train_rescoring:RescoringTraining",
        "Train the network that corrects scores and boxes of the cascade's detections.",
    ),
    "box-refinement": (
        "detector.train_box_refinement:BoxRefinementTraining",
        "Train the network that corrects the boxes of the detector's final detections.",
    ),
    "occlusion": (
        "occlusion:OcclusionTraining",
        "Train the classifier that decides which of two overlapping people is in front.",
    ),
    "foreground": (
        "foreground:ForegroundTraining",
        "Train the network that separates people from background in panoramas.",
    ),
    "places": (
        "places:PlacesTraining",
        "Train the networks that find and locate people in patches of panoramas.",
    ),
    "distance": (
        "distance:DistanceTraining",
        "Train the network that estimates the distance of a person in a panorama.",
    ),
    "legs": (
        "legs:LegsTraining",
        "Train the networks that detect people by their legs in laser scans.",
    ),
    "windows": (
        "windows:WindowsTraining",
        "Train the support vector machines that decide whether a window shows a person.",
    ),
}
"""For each model, the location of its specification and a description."""

_PACKAGES: Final = {"jax": "jax", "optax": "optax", "sklearn": "scikit-learn"}  # of the extra `train`

Data = TypeVar("Data")


@dataclass(frozen=True, slots=True, kw_only=True)
class Specification(ABC, Generic[Data]):
    """Specification of a model's training: its fields are the options, its methods are the steps.

    Every model has an option `sequences`, the number of sequences to render or run for training. A trained
    model is a dataclass with `about`, a description that is stored in its file, and `save(path)`.
    """

    SHIPPED_IN: ClassVar[Path] = SHIPPED
    HINT: ClassVar[str] = ""
    """Next step for the user, printed after training."""

    sequences: int

    def default_folder(self, model: str) -> Path:
        """Return the default folder of samples and weights."""
        return Path("runs") / model

    @abstractmethod
    def tasks(self, out: Path) -> Tasks:
        """Return the tasks that collect samples; files that are already in the folder are reused.

        Raises:
            BadInput: sequences that cannot be used.
        """

    def load(self, tasks: Tasks) -> Data:
        """Load the results of the tasks; by default a model is trained on the files themselves.

        Raises:
            BadInput: there are too few samples.
        """
        return cast(Data, tasks)

    @abstractmethod
    def fit(self, data: Data) -> Mapping[str, Any]:
        """Train on samples, and return the trained models by file name.

        Raises:
            BadInput: a package is missing, or there are too few samples.
        """

    @abstractmethod
    def evaluate(self, model: Any, data: Data) -> Mapping[str, str]:
        """Evaluate a trained model on the validation split, and return the results by data set."""

    def is_replaced(self, path: Path, model: Any) -> bool:  # noqa: ARG002
        """Return whether a shipped file is removed when a model is shipped under another name."""
        return False


def load_specification(model: str) -> type[Specification[Any]]:
    """Return the specification of a model.

    Raises:
        BadInput: its packages are missing.
    """
    module, name = MODELS[model][0].split(":")
    try:
        found: type[Specification[Any]] = getattr(import_module(f"peopleboy.studies.training.{module}"), name)
    except ModuleNotFoundError as error:
        if error.name not in _PACKAGES:
            raise
        raise missing_package(model, _PACKAGES[error.name]) from None
    return found


def train(specification: Specification[Data], out: Path, workers: Workers, *, ship: bool) -> Sequence[Path]:
    """Collect samples, train on them, evaluate the models, and write them.

    Args:
        specification: specification of the model.
        out: folder of samples, and of the weights unless they are shipped.
        workers: number of processes that collect samples.
        ship: whether to write the weights to the folder of weights that are shipped with the trackers.

    Raises:
        BadInput: a path that cannot be used, a missing package, or too few samples; a new empty folder is
            removed again.
        TasksFailed: some sequences failed, after all others were done.
    """
    with writing_to(out):
        out.mkdir(parents=True, exist_ok=True)
    try:
        tasks = specification.tasks(out)
        collect_missing(tasks, workers)
    finally:
        with suppress(OSError):
            out.rmdir()
    data = specification.load(tasks)
    paths = []
    for file, model in specification.fit(data).items():
        results = specification.evaluate(model, data)
        for where, result in results.items():
            report(f"{Path(file).stem}, {where}: {result}")
        folder = specification.SHIPPED_IN if ship else out
        with writing_to(folder):
            folder.mkdir(parents=True, exist_ok=True)
            with atomic(folder / file) as part:
                replace(model, about={**model.about, **results}).save(part)
        for path in sorted(folder.iterdir()) if ship else ():
            if path.name != file and specification.is_replaced(path, model):
                path.unlink()
        paths.append(folder / file)
    return paths


def report(line: str) -> None:
    """Print a line of progress to standard error."""
    Console(stderr=True).print(line, highlight=False)


def missing_package(what: str, package: str) -> BadInput:
    """Return the error for a training whose package is not installed."""
    return BadInput(f"training of {what} needs {package}: pip install {package}")
