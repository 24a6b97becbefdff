"""Render a data set: choose its runs, run them, then write splits, statistics, checks and the datasheet."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from pydantic import Field

from peopleboy.bad_input import BadInput, found_in
from peopleboy.scenarios.export.dataset_checks import Check, check_set
from peopleboy.scenarios.export.datasheet import Statistics, measure, write_datasheet
from peopleboy.scenarios.export.splits import (
    ABOUT,
    SPLITS,
    is_set,
    lacking_splits,
    split_file,
    split_lines,
    split_of,
)
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.random_worlds.distribution import Distribution, narrowed
from peopleboy.scenarios.random_worlds.drawn_values import drawn_values, histograms
from peopleboy.scenarios.random_worlds.random_world import world_name
from peopleboy.scenarios.run_folder.atomic_output import check_named, writing_to
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.run_folder.frame_choice import FrameChoice
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.scenarios.running.many_runs import RunTask, play, unfinished
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.settings import Metavar
from peopleboy.sim.physics.physics_engine import check_physics


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """A run of a set: its scenario (None: the random world of its seed), its seed, and its folder's name."""

    scenario: Scenario | None
    seed: int
    name: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SetContents:
    """Planned contents of a set.

    Attributes:
        members: its runs, in order.
        asked: arguments of the command that requests them.
        about: the request as written to `dataset.json`.
        lacking: the splits without a run, and the number of seeds needed; empty if all have one.
        distribution: distribution of the random worlds; None for scenarios.
    """

    members: tuple[Member, ...]
    asked: tuple[str, ...]
    about: Mapping[str, Any]
    lacking: str
    distribution: Distribution | None = None


def of_scenarios(scenarios: Sequence[str], seeds: range) -> SetContents:
    """Return the contents of a set of scenarios, given by name or path, each with all seeds.

    Raises:
        BadInput: a scenario cannot be loaded, or two have the same name.
    """
    loaded = [load_scenario(scenario) for scenario in scenarios]
    names = [scenario.name for scenario in loaded]
    if len(set(names)) < len(names):
        raise BadInput(f"render: {', '.join(names)}: two scenarios have the same name; give each once")
    return SetContents(
        members=tuple(
            Member(scenario, seed, f"{scenario.name}-{seed}") for scenario in loaded for seed in seeds
        ),
        asked=tuple(scenarios),
        about={"scenarios": names} | _about(seeds),
        lacking=lacking_splits(seeds),
    )


def of_worlds(seeds: range, given: Mapping[str, Any] | None = None, asked: Sequence[str] = ()) -> SetContents:
    """Return the contents of a set of random worlds, one for each seed.

    Args:
        seeds: seeds of the worlds.
        given: parts of the distribution that are replaced, see `narrowed`; None for none.
        asked: options of the command that replace them.

    Raises:
        BadInput: the distribution is invalid.
    """
    given = given or {}
    return SetContents(
        members=tuple(Member(None, seed, world_name(seed)) for seed in seeds),
        asked=("--random-worlds", *asked),
        about={"random_worlds": True} | ({"distribution": given} if given else {}) | _about(seeds),
        lacking=lacking_splits(seeds),
        distribution=narrowed(given),
    )


def _about(seeds: range) -> dict[str, int]:
    return {"seeds": len(seeds), "first_seed": seeds.start}


DRAWN: Final = "drawn.json"
"""File with the sampled values of each random world of a set."""


_PLACES: Final = {
    "rooms": ["room"],
    "corridors": ["corridor", "l_corridor", "t_corridor"],
    "streets": ["street"],
}
"""Kinds of places in the distribution of random worlds, by value of `--only`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SetOptions:
    """Contents of a set, scenarios with many seeds or random worlds, and how it is rendered.

    Attributes:
        seeds: seeds of the runs of each scenario, or of the random worlds.
        choice: frames of each run that are written.
    """

    scenarios: tuple[str, ...] = ()
    frames: Annotated[
        bool, Field(description="Write images in addition to ground truth, as `run --frames` does.")
    ] = False
    random_worlds: Annotated[
        bool, Field(description="Render one random world per seed instead of scenarios.")
    ] = False
    distribution: Annotated[
        Path | None,
        Field(
            description="YAML file with parts of the distribution of random worlds to replace, such as "
            "`people: [1, 4]`."
        ),
    ] = None
    only: Annotated[
        Literal["rooms", "corridors", "streets"] | None,
        Field(description="Kind of place of all random worlds.  [default: all kinds]"),
    ] = None
    camera_height_m: Annotated[
        tuple[float, float] | None,
        Field(
            description="Range of the height of the cameras in random worlds, in m.  [default: 0.4 to 1.8]"
        ),
        Metavar("LOW HIGH"),
    ] = None
    pitch_deg: Annotated[
        tuple[float, float] | None,
        Field(
            description="Range of the pitch of the cameras in random worlds, in degrees; positive is down."
            "  [default: -15 to 15]"
        ),
        Metavar("LOW HIGH"),
    ] = None
    seeds: range = range(100)
    out: Annotated[
        Path | None,
        Field(description="Output folder.  [default: sets/SCENARIO-SCENARIO..., or sets/worlds]"),
    ] = None
    tracker: Annotated[str, Field(description="Tracker of robots that follow people.")] = "truth"
    choice: FrameChoice = field(default_factory=FrameChoice)

    def contents(self) -> SetContents:
        """Return the runs.

        Raises:
            BadInput: options contradict each other, or a scenario cannot be loaded.
        """
        if bool(self.scenarios) is self.random_worlds:
            raise BadInput("render: give either scenarios or --random-worlds")
        if not self.choice.is_all and not self.frames:
            raise BadInput(f"{self.choice.options()}: chooses images; give --frames as well")
        if self.random_worlds:
            return of_worlds(self.seeds, self._given(), self._asked_of_worlds())
        for option in (asked for asked in self._asked_of_worlds() if asked.startswith("--")):
            raise BadInput(f"{option}: applies to random worlds; give --random-worlds, or omit the option")
        return of_scenarios(self.scenarios, self.seeds)

    def _given(self) -> dict[str, Any]:
        """Return the parts of the distribution to replace; options override the file.

        Raises:
            BadInput: the file cannot be read, or a name or value in it is invalid.
        """
        given = {} if self.distribution is None else read_yaml(self.distribution)
        with found_in(file=str(self.distribution)):
            narrowed(given)
        options = {
            "only": ("place", None if self.only is None else _PLACES[self.only]),
            "camera-height-m": ("camera_height", self.camera_height_m),
            "pitch-deg": ("pitch", self.pitch_deg),
        }
        for option, (name, value) in options.items():
            if value is not None:
                with found_in(f"--{option}"):
                    narrowed({name: list(value)})
                given[name] = list(value)
        return given

    def _asked_of_worlds(self) -> tuple[str, ...]:
        """Return the options of random worlds as arguments of the command."""
        options = {
            "--distribution": None if self.distribution is None else [self.distribution],
            "--only": None if self.only is None else [self.only],
            "--camera-height-m": self.camera_height_m,
            "--pitch-deg": self.pitch_deg,
        }
        asked = ((flag, *map(str, values)) for flag, values in options.items() if values is not None)
        return tuple(word for words in asked for word in words)

    def folder(self, contents: SetContents) -> Path:
        """Return the folder of the set."""
        return self.out or Path("sets") / "-".join(contents.about.get("scenarios", ["worlds"]))

    def asked(self, contents: SetContents) -> tuple[str, ...]:
        """Return the arguments and options of the command that renders this set, except the seeds."""
        frames = ("--frames",) if self.frames else ()
        return (*contents.asked, *frames, *self.choice.options().split())


@dataclass(frozen=True, slots=True, kw_only=True)
class RenderedSet:
    """A finished set.

    Attributes:
        folder: folder of the set.
        runs: folders of its runs, in the order of the contents.
        statistics: statistics of each split that has runs, and of "all".
        checks: results of the checks.
        size_mb: [MB] of the runs on disk, without exports in the same folder.
        lacking: the splits without a run, and the number of seeds needed; empty if all have one.
    """

    folder: Path
    runs: tuple[Path, ...]
    statistics: dict[str, Statistics]
    checks: tuple[Check, ...]
    size_mb: float
    lacking: str

    def to_json(self) -> dict[str, Any]:
        """Return the summary of the set for JSON."""
        return {
            "folder": str(self.folder),
            "runs": [run.name for run in self.runs],
            "size_mb": self.size_mb,
            "checks": [asdict(check) for check in self.checks],
            "statistics": {name: each.to_json() for name, each in self.statistics.items()},
            "lacking": self.lacking,
        }

    @property
    def is_sound(self) -> bool:
        """Whether every check passes."""
        return not any(check.failures for check in self.checks)


def render_set(options: SetOptions, workers: Workers) -> RenderedSet:
    """Render a set; complete runs that exist already are kept.

    The datasheet and `dataset.json` are written last: a set without them is unfinished.

    Args:
        options: contents of the set, and how it is rendered.
        workers: workers that execute the runs.

    Raises:
        BadInput: as for a run; or the folder contains something other than a set.
        TasksFailed: some runs failed.
    """
    contents = options.contents()
    folder, choice = options.folder(contents), None if options.choice.is_all else options.choice
    members = contents.members
    for scenario in {member.scenario for member in members if member.scenario is not None}:
        check_physics(scenario.spec.physics)
    _check(folder)
    tasks = [
        RunTask(
            member.scenario,
            RunOptions(
                seed=member.seed,
                out=folder / member.name,
                frames=options.frames,
                tracker=options.tracker,
                record=False,
                choice=choice,
            ),
            contents.distribution,
        )
        for member in members
    ]
    waiting = unfinished(tasks)
    _claim(folder)
    runs = tuple(task.options.out for task in tasks)
    numbers = [member.seed for member in members]
    _write_splits(folder, [run.name for run in runs], numbers)
    play(waiting, workers, folder.name)
    done = RenderedSet(
        folder=folder,
        runs=runs,
        statistics=_statistics(runs, numbers),
        checks=tuple(check_set(folder, runs, tasks[0].played, tasks[0].options)),
        size_mb=sum(path.stat().st_size for run in runs for path in run.rglob("*") if path.is_file()) / 1e6,
        lacking=contents.lacking,
    )
    about = {**contents.about, "images": options.frames, "tracker": options.tracker, "versions": versions()}
    about |= {} if choice is None else {"choice": choice.to_json()}
    scenarios = list(dict.fromkeys(member.scenario for member in members if member.scenario is not None))
    drawn, distribution = {}, contents.distribution or Distribution()
    if contents.distribution is not None:
        # Reading a world from its folder is faster than to sample it again.
        scenarios = [load_scenario(run / "scenario.yaml") for run in runs]
        drawn = {run.name: drawn_values(read_yaml(run / "scenario.yaml")) for run in runs}
        (folder / DRAWN).write_text(json.dumps(drawn, indent=1) + "\n", encoding="utf-8")
    content = about | {
        "asked": options.asked(contents),
        "choice": choice,
        "size_mb": done.size_mb,
        "lacking": done.lacking,
        "drawn": histograms(list(drawn.values()), distribution),
    }
    write_datasheet(folder / "README.md", done.statistics, done.checks, content, scenarios, distribution)
    _write_about(done, about)
    return done


def _check(folder: Path) -> None:
    """Refuse a folder that contains something other than a set.

    Raises:
        BadInput: it does.
    """
    check_named(folder)
    if folder.exists() and (not folder.is_dir() or (any(folder.iterdir()) and not is_set(folder))):
        raise BadInput(f"{folder}: contains something other than a rendered set; give another --out")


def _claim(folder: Path) -> None:
    """Create the folder, and remove the files that mark a set as finished."""
    with writing_to(folder):
        (folder / "splits").mkdir(parents=True, exist_ok=True)
    for name in ("README.md", ABOUT, DRAWN):
        (folder / name).unlink(missing_ok=True)


def _write_splits(folder: Path, names: Sequence[str], seeds: Sequence[int]) -> None:
    for split in SPLITS:
        split_file(folder, split).write_text(split_lines(names, seeds, split), encoding="utf-8")


def _statistics(runs: Sequence[Path], seeds: Sequence[int]) -> dict[str, Statistics]:
    groups = {"all": list(runs)} | {
        split: [run for run, seed in zip(runs, seeds, strict=True) if split_of(seed) == split]
        for split in SPLITS
    }
    return {name: measure(group) for name, group in groups.items() if group}


def _write_about(done: RenderedSet, about: dict[str, Any]) -> None:
    content = about | {
        "runs": [run.name for run in done.runs],
        "statistics": {name: each.to_json() for name, each in done.statistics.items()},
        "checks": [asdict(check) for check in done.checks],
    }
    (done.folder / ABOUT).write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
