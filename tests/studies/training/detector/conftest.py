from pathlib import Path

import pytest

from peopleboy.studies.training.detector import crop_samples, train_cascade
from peopleboy.studies.training.detector.world_sequences import ThermalImage, load_images
from peopleboy.studies.training.samples import SampleTask
from peopleboy.tracker.networks.inference import NetworkLayer
from peopleboy.tracker.sensors.thermal.detector.rescoring import BoxRefinementNetwork, RescoringNetwork
from tests.helpers.images.drawn_films import drawn_film


@pytest.fixture(scope="session")
def shots(tmp_path_factory: pytest.TempPathFactory) -> list[ThermalImage]:
    """Images of eight drawn films, six each."""
    folder = tmp_path_factory.mktemp("films")
    for seed in range(8):
        drawn_film(seed).save(folder / f"{seed}.npz")
    return list(load_images(sorted(folder.iterdir())))


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Networks that are trained in a second, as those that are shipped are in hours."""
    layers = (NetworkLayer(5, 4, 8), NetworkLayer(3, 1, 12), NetworkLayer(3, 2, 8))
    for network in (RescoringNetwork, BoxRefinementNetwork):
        architecture = network.ARCHITECTURE._replace(layers=layers, units=24)
        monkeypatch.setattr(network, "ARCHITECTURE", architecture)


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drawn sequences instead of rendered ones."""
    for module in (train_cascade, crop_samples):
        monkeypatch.setattr(module, "render_task", drawn_task)


def drawn_task(folder: Path, seed: int) -> SampleTask:
    return SampleTask(folder / f"world_{seed}.npz", drawn_film, (seed, 3))
