"""Split data sets into training, validation and test runs, so that exports keep test runs apart."""

from collections.abc import Sequence
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import FinishedRun

ABOUT = "dataset.json"
"""File that only a finished set has."""

SPLITS = ("train", "val", "test")
_TURNS = ("train", "train", "train", "train", "train", "val", "test")


def split_of(seed: int) -> str:
    """Return the split of a seed, in every scenario: five sevenths train, one val, one test.

    It does not depend on the number of seeds, so that runs keep their split when a set grows.
    """
    return _TURNS[seed % len(_TURNS)]


def split_lines(names: Sequence[str], seeds: Sequence[int], split: str) -> str:
    """Return the file of a split, with the folders of its runs, one per line."""
    return "".join(f"{name}\n" for name, seed in zip(names, seeds, strict=True) if split_of(seed) == split)


def split_file(folder: Path, split: str) -> Path:
    """Return the file with the names of a split's runs."""
    return folder / "splits" / f"{split}.txt"


def lacking_splits(seeds: range) -> str:
    """Describe the splits without a run, and the number of seeds needed; empty if each has one."""
    empty = [split for split in SPLITS if split not in map(split_of, seeds)]
    if not empty:
        return ""
    count = len(seeds)
    while not set(SPLITS) <= set(map(split_of, range(seeds.start, seeds.start + count))):
        count += 1
    return f"{' and '.join(empty)} {'are' if len(empty) > 1 else 'is'} empty; give --seeds {count}"


def read_split(run: Path) -> str | None:
    """Return the split of a run's folder; None if it is not in a rendered set.

    Raises:
        BadInput: the run is in a set, but in none or several of its splits.
    """
    folder = run.resolve().parent
    files = {split: split_file(folder, split) for split in SPLITS}
    if not any(file.is_file() for file in files.values()):
        return None
    try:
        own = [
            split for split, file in files.items() if run.resolve().name in file.read_text("utf-8").split()
        ]
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{folder / 'splits'}: cannot be read; render the set again") from error
    if len(own) != 1:
        raise BadInput(
            f"{run}: must be in one split, is in {' and '.join(own) or 'none'} of {folder / 'splits'}; "
            "render the set with all its seeds, or move this run away"
        )
    return own[0]


def refuse_unfinished(folder: Path) -> None:
    """Refuse an unfinished set, of which runs may be missing; accept folders that are no set.

    Raises:
        BadInput: the set is not finished.
    """
    if is_set(folder) and not (folder / ABOUT).is_file():
        raise BadInput(
            f"{folder}: this set is not finished; repeat its `peopleboy render` to complete it, "
            "or give single runs of it"
        )


def is_set(folder: Path) -> bool:
    """Return whether a folder is a rendered set, finished or not."""
    return (folder / "splits").is_dir()


def by_split(runs: Sequence[FinishedRun]) -> dict[str | None, list[FinishedRun]]:
    """Group runs by the splits of their rendered sets; the only key is None if they are in none.

    Raises:
        BadInput: only some runs are in rendered sets, or one is not in its set's splits.
    """
    found: dict[str | None, list[FinishedRun]] = {}
    for run in runs:
        found.setdefault(read_split(run.folder), []).append(run)
    if None in found and len(found) > 1:
        raise BadInput(
            f"{found[None][0].folder}: is not in a rendered set, while other runs are and have splits; "
            "export them separately"
        )
    return {split: found[split] for split in (None, *SPLITS) if split in found}
