import re
import tomllib
from pathlib import Path

import pytest
import yaml
from PIL import Image

from docs.generate.reference.library import library_groups
from peopleboy.scenarios.files.library import library

ROOT = Path(__file__).parents[2]
README, RESULTS = (ROOT / name for name in ("README.md", "docs/results.md"))
NUMBER = r"\d+(?:\.\d+)?"


def section(title: str) -> str:
    return README.read_text(encoding="utf-8").split(f"## {title}\n")[1].split("\n## ")[0]


def version() -> str:
    return str(tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"])


def test_the_readme_is_short() -> None:
    assert len(README.read_text(encoding="utf-8").splitlines()) <= 100


def test_every_figure_of_the_readme_is_one_of_the_results() -> None:
    measured = set(re.findall(NUMBER, RESULTS.read_text(encoding="utf-8")))
    rows = [line.split("|")[2:4] for line in section("Benchmark").splitlines() if line.startswith("| ")][1:]
    given = {number for row in rows for cell in row for number in re.findall(NUMBER, cell)}
    assert len(rows) == 6
    assert given <= measured


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/results.md"])
def test_what_a_page_of_the_repository_points_to_is_there(name: str) -> None:
    page = ROOT / name
    text = page.read_text(encoding="utf-8")
    # Badges point to the repository's Actions page, relative to the README's address.
    links = [
        link.partition("#")[0] for link in re.findall(r"\]\((?!https?:|#|\.\./\.\./actions/)([^)]+)\)", text)
    ]
    assert not [link for link in links if not (page.parent / link).exists()]


def test_what_a_page_says_of_the_api_is_a_link_into_the_reference() -> None:
    # mkdocs leaves the brackets of others as they are, and says nothing.
    pages = {path: path.read_text(encoding="utf-8") for path in (ROOT / "docs").rglob("*.md")}
    modules = {name for text in pages.values() for name in re.findall(r"^::: (\S+)", text, re.MULTILINE)}
    asked = {name for text in pages.values() for name in re.findall(r"\]\[(peopleboy[\w.]+)\]", text)}
    assert len(asked) > 20
    assert not [name for name in sorted(asked) if not {name, name.rpartition(".")[0]} & modules]


def test_the_files_that_contributors_are_sent_to_are_there() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = [word for word in re.findall(r"`([\w./]+/[\w./]*)`", text) if "NAME" not in word]
    made = ("runs/", "build/")
    assert len(named) > 30
    assert not [word for word in named if not word.startswith(made) and not (ROOT / word).exists()]


def test_changelog_and_citation_are_of_this_version() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert (citation["cff-version"], citation["version"]) == ("1.2.0", version())
    assert f"## [{version()}]" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_every_scenario_of_the_library_is_in_one_group() -> None:
    named = [name for group in library_groups() for name in group.scenarios]
    assert sorted(named) == sorted(library())


def test_every_scenario_of_the_gallery_has_its_plan() -> None:
    plans = {path.stem for path in (ROOT / "docs/pictures/gallery").glob("*.webp")}
    assert plans == set(library())


def test_the_moving_picture_of_the_readme_is_small() -> None:
    path = ROOT / "docs/pictures/crossing.webp"
    assert 100_000 < path.stat().st_size <= 2_000_000
    with Image.open(path) as picture:
        assert getattr(picture, "n_frames", 1) > 30
