from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.studies.training.detector.world_sequences import ThermalSequence, render_thermal
from peopleboy.tracker.camera_mount import Mount


@pytest.mark.slow
def test_a_film_of_a_random_world_tells_who_is_where(tmp_path: Path) -> None:
    film = render_thermal(random_scenario(3, 0.4), 3)
    assert film.grey.shape == film.change.shape
    assert len(film.grey) == 1
    assert film.box.shape == (len(film.image), 4)
    assert set(film.image.tolist()) <= set(range(len(film.grey)))
    film.save(tmp_path / "film.npz")
    read = ThermalSequence.load(tmp_path / "film.npz")
    for name in film.__dataclass_fields__:
        np.testing.assert_array_equal(getattr(read, name), getattr(film, name))
    assert isinstance(read.camera_mount(), Mount)
