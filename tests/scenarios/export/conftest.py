from pathlib import Path

import pytest

from tests.helpers.runs.exported import FOLLOWING, SCENE, export, make_run


@pytest.fixture(scope="session")
def crossing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_run(SCENE, tmp_path_factory.mktemp("crossing") / "tiny-3", "--seed", 3, "--frames")


@pytest.fixture(scope="session")
def following(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_run(FOLLOWING, tmp_path_factory.mktemp("following") / "follow-0", "--frames")


@pytest.fixture(scope="session")
def coco_folder(crossing: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(crossing, "coco", tmp_path_factory.mktemp("coco") / "set")
