"""List the packages: the rooms lie at the top level, and src/peopleboy links to them.

Where the links are lost, as in an archive unpacked on Windows, the rooms are taken from where they lie.
"""

import sys
from pathlib import Path

from setuptools import find_packages, setup

ROOMS = ("behaviours", "geometry", "scenarios", "sim", "studies", "tracker")

HERE = Path(__file__).parent
PACKAGE = HERE / "src" / "peopleboy"


def layout() -> tuple[list[str], dict[str, str]]:
    """Return the names of all packages, and the folders of those that do not lie below src."""
    lost = [room for room in ROOMS if not (PACKAGE / room / "__init__.py").is_file()]
    if missing := [room for room in lost if not (HERE / room / "__init__.py").is_file()]:
        sys.exit(
            f"peopleboy cannot be built: the folder {missing[0]}/ is missing beside setup.py; "
            "take the whole archive or a clone"
        )
    packages = find_packages("src")
    for room in lost:
        packages += [f"peopleboy.{room}", *(f"peopleboy.{room}.{name}" for name in find_packages(room))]
    return packages, {"": "src", **{f"peopleboy.{room}": room for room in lost}}


packages, package_dir = layout()
setup(packages=packages, package_dir=package_dir)
