import pytest

from peopleboy.studies.training.people_learning.shots import PeopleShot, shots_of
from tests.helpers.images.drawn_films import drawn_film


@pytest.fixture(scope="session")
def shots(tmp_path_factory: pytest.TempPathFactory) -> list[PeopleShot]:
    """Images of eight drawn films, six each."""
    folder = tmp_path_factory.mktemp("films")
    for seed in range(8):
        drawn_film(seed).save(folder / f"{seed}.npz")
    return list(shots_of(sorted(folder.iterdir())))
