"""Derive the options of commands from the fields of dataclasses.

Each field with a description becomes an option with the field's name, limits and default: a flag for a
boolean, a choice for a few fixed values, otherwise a number, a path or a string. `options_of` adds the
options to a command and passes their values to it as one `GivenOptions`, which makes the dataclass.
"""

import json
import logging
import math
import reprlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, dataclass
from enum import Enum
from functools import wraps
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Generic, TypeVar, cast, get_args

import click

from peopleboy.scenarios.commands.completion import (
    BEHAVIOUR_NAMES,
    TRACKER_NAMES,
    complete_names,
    complete_scenario,
)
from peopleboy.tracker.trackers import WITH_DETECTOR
from peopleboy.user_files import is_stream

if TYPE_CHECKING:
    from peopleboy.settings import Setting

SEED = "Random seed.  [default: 0, or the seed of the run if SCENARIO is a run's scenario.yaml]"
TRACKERS = f"{', '.join(TRACKER_NAMES)}, truth (ground-truth boxes) or module:Class (your own)"
TRACKER = f"Tracker to use: {TRACKERS}.  [default: the scenario's tracker, or detection]"
DETECTOR = (
    "Detector that replaces the tracker's own: module:Class (your own), a MOTChallenge file of detections "
    f"(.txt), or a network of `peopleboy train people` (.npz). For the trackers {', '.join(WITH_DETECTOR)}.  "
    "[default: the tracker's own]"
)
BEHAVIOURS = f"{', '.join(BEHAVIOUR_NAMES)} or module:Class (your own)"
BEHAVIOUR = f"Behaviour that drives the robot: {BEHAVIOURS}.  [default: the scenario's behaviour]"

MOST_SEEDS: Final = 100_000


class PlainPath(click.Path):
    """A path that may not exist; pipes and devices are refused, as reading them may never end."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """Convert a value to a path."""
        path = Path(value)
        try:
            path = Path(str(super().convert(value, param, ctx)))
            str(path).encode()  # as text of another encoding cannot be written to run.json
            path.resolve()  # finds links in a ring
            is_other = is_stream(path)
        except (OSError, ValueError, RuntimeError) as error:
            reason = getattr(error, "strerror", None) or error
            self.fail(f"{reprlib.repr(str(path))}: cannot be a path: {reason}", param, ctx)
        if is_other:
            self.fail(f"{path} is a pipe or a device; give a file or a folder", param, ctx)
        return path


PATH: Final = PlainPath()

C = TypeVar("C")
Command = TypeVar("Command", bound=Callable[..., None])


class WholeNumber(click.IntRange):
    """A whole number within limits; an invalid value raises an error that states the limits."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """Convert a value to an int."""
        try:
            return int(super().convert(value, param, ctx))
        except click.BadParameter:
            return self.fail(f"must be a whole number {_limits(self)}, got {value}", param, ctx)


class Number(click.FloatRange):
    """A number within limits; an invalid value raises an error that states the limits."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Convert a value to a float."""
        try:
            number = float(super().convert(value, param, ctx))
        except click.BadParameter:
            number = math.nan
        if not math.isfinite(number):
            self.fail(f"must be a number {_limits(self)}, got {value}", param, ctx)
        return number


def _limits(number: WholeNumber | Number) -> str:
    if number.max is None:
        return f"of at least {number.min:g}"
    return f"from {number.min:g} to {'less than ' * number.max_open}{number.max:g}"


@dataclass(frozen=True, slots=True)
class GivenOptions(Generic[C]):
    """Values that the user gave on the command line for the fields of a dataclass.

    Attributes:
        config: the dataclass.
        values: the given values, by field.
    """

    config: type[C]
    values: Mapping[str, Any]

    def __getattr__(self, field: str) -> Any:
        """Return the value of a field, or None if the user did not give it."""
        return self.values.get(field)

    def make(self, **derived: Any) -> C:
        """Make the dataclass from the given values and `derived`; all other fields get their defaults."""
        return self.config(**{**self.values, **derived})


@dataclass(frozen=True, slots=True)
class _FieldOptions:
    """Options for some fields of a dataclass, which is imported when the options are needed.

    A list of all commands needs no options, so it must not wait for these imports.
    """

    target: str
    fields: tuple[str, ...]
    is_optional: bool
    meanings: Mapping[str, str]

    def config(self) -> type[Any]:
        module, _, name = self.target.partition(":")
        config: type[Any] = getattr(import_module(f"peopleboy.{module}"), name)
        return config

    def settings(self) -> "list[Setting]":
        from peopleboy.settings import settings_of

        known = {setting.field: setting for setting in settings_of(self.config())}
        return [known[field] for field in self.fields]

    def options(self) -> Iterator[click.Parameter]:
        for setting in self.settings():
            meaning = self.meanings.get(setting.field, setting.meaning)
            is_required = setting.is_required and not self.is_optional and "[default:" not in meaning
            yield _option(setting, meaning, is_required=is_required)

    def given(self, values: dict[str, Any]) -> GivenOptions[Any]:
        """Move the values of these fields out of the values of a command."""
        taken = {setting.field: _taken(setting, values.pop(setting.field)) for setting in self.settings()}
        return GivenOptions(
            self.config(), {field: value for field, value in taken.items() if value is not None}
        )


class FieldsCommand(click.Command):
    """A command with --verbose, whose `options_of` become parameters when they are first needed."""

    _params: list[Any]
    _is_expanded: bool

    @property
    def params(self) -> list[click.Parameter]:
        """All parameters; always the same list, because click appends to it."""
        if not self._is_expanded:
            fields = [each.options() if isinstance(each, _FieldOptions) else [each] for each in self._params]
            own = [param for params in fields for param in params]
            self._params, self._is_expanded = [*own, _verbose_option()], True
        return self._params

    @params.setter
    def params(self, params: list[Any]) -> None:
        self._params, self._is_expanded = params, False


def options_of(
    target: str, *fields: str, into: str = "given", is_optional: bool = False, **meanings: str
) -> Callable[[Command], Command]:
    """Give a `FieldsCommand` one option for each of these fields of a dataclass.

    The command receives the values as one `GivenOptions`. A field marked as `POSITIONAL` becomes an argument.

    Args:
        target: the dataclass, as "module:Class" below `peopleboy`.
        fields: names of the fields, in the order of the help.
        into: name of the command's parameter.
        is_optional: whether fields without a default are optional as well.
        meanings: help texts that replace those of the fields.
    """
    options = _FieldOptions(target, fields, is_optional, meanings)

    def decorate(command: Command) -> Command:
        @wraps(command)
        def with_given(*arguments: Any, **values: Any) -> None:
            given = options.given(values)
            command(*arguments, **{into: given}, **values)

        # click's own decorators keep their options in this attribute until the command is made.
        with_given.__dict__.setdefault("__click_params__", []).append(options)
        return cast(Command, with_given)

    return decorate


class SpeltChoice(click.Choice[str]):
    """A choice whose values keep their spelling, such as FFmpeg's `gray16`, and may have the American one."""

    def normalize_choice(self, choice: object, ctx: click.Context | None) -> str:
        """Return a choice as it is spelt, and other words in the options' spelling."""
        return str(choice) if choice in self.choices else super().normalize_choice(choice, ctx)


def _option(setting: "Setting", meaning: str, *, is_required: bool) -> click.Parameter:
    if setting.is_positional:
        metavar = f"[{setting.field.upper()}]"
        return click.Argument(
            [setting.field], required=False, metavar=metavar, shell_complete=complete_scenario
        )
    flag = f"--{setting.key.replace('_', '-')}"
    if setting.kind is bool:  # a setting that is on by default has a negated key, such as no_recording
        return click.Option([flag, setting.field], is_flag=True, help=meaning)
    if setting.default is not MISSING and setting.default is not None and "[default:" not in meaning:
        # Do not pass the default to click, so that the command can tell which values the user gave.
        default = ", ".join(map(str, setting.default)) if _is_many(setting) else setting.default
        meaning += f"  [default: {default}]"
    choices = _choices(setting)
    return click.Option(
        [flag, setting.field],
        type=SpeltChoice(choices) if choices else _type(setting),
        required=is_required,
        metavar=setting.metavar,
        multiple=_is_many(setting),
        shell_complete=None if choices else _COMPLETED.get(setting.field),
        help=meaning,
    )


def _is_many(setting: "Setting") -> bool:
    """Return whether the option can be given several times."""
    return get_args(setting.kind)[1:] == (...,)


def _choices(setting: "Setting") -> list[str]:
    return [str(choice) for choice in (get_args(setting.kind)[0] if _is_many(setting) else setting.choices)]


def _type(setting: "Setting") -> Any:
    low, high = setting.limits.get("ge"), setting.limits.get("le", setting.limits.get("lt"))
    if setting.kind is int:
        # The limits are stored as floats; convert them for a whole number.
        return WholeNumber(None if low is None else int(low), None if high is None else int(high))
    if setting.kind is float:
        return Number(low, high, max_open="lt" in setting.limits) if low is not None else float
    if setting.kind is Path:
        return PATH
    # A pair of numbers takes two arguments on the command line.
    return (float, float) if setting.kind == tuple[float, float] else str


def _taken(setting: "Setting", value: Any) -> Any:
    if setting.kind is bool:
        return not setting.default if value else None
    if _is_many(setting):
        return tuple(map(get_args(setting.kind)[0], value)) or None
    if setting.field in _NAMES and isinstance(value, str) and value.isidentifier():
        return british(value)
    is_enum = isinstance(setting.kind, type) and issubclass(setting.kind, Enum)
    return setting.kind(value) if is_enum and value is not None else value


complete_trackers = complete_names((*TRACKER_NAMES, "truth"))
_COMPLETED: Final = {"tracker": complete_trackers, "behaviour": complete_names(BEHAVIOUR_NAMES)}

_NAMES: Final = ("tracker", "camera")
"""Fields whose values are names such as `colour`, which may also have the American spelling."""

_AMERICAN: Final = {"color": "colour", "behavior": "behaviour", "randomize": "randomise", "gray": "grey"}


def british(word: str) -> str:
    """Return a command-line word in the options' spelling: `color` becomes `colour`."""
    for american, ours in _AMERICAN.items():
        word = word.replace(american, ours)
    return word


_COUNT = "Number of worker processes; 1 runs everything in the current process.  [default: one per core]"
_ADDRESS = "Address of a Dask scheduler, to run on its cluster instead."


def workers_options(command: Callable[..., None]) -> Callable[..., None]:
    """Add the options for parallel work; the command receives a `Workers` named `workers`."""

    @wraps(command)
    def with_workers(*arguments: Any, workers: int | None, scheduler: str | None, **options: Any) -> None:
        from peopleboy.scenarios.running.engine.task import chosen_workers

        command(*arguments, workers=chosen_workers(workers, scheduler), **options)

    scheduler_option = click.option("--scheduler", metavar="tcp://...", help=_ADDRESS)
    return click.option("--workers", type=WholeNumber(min=1), help=_COUNT)(scheduler_option(with_workers))


def seeds_options(count: int, first: int = 0) -> Callable[[Command], Command]:
    """Add --seeds and --first-seed with these defaults; the command receives a range named `seeds`."""

    def decorate(command: Command) -> Command:
        @wraps(command)
        def with_seeds(*arguments: Any, seeds: int, first_seed: int, **options: Any) -> None:
            command(*arguments, seeds=range(first_seed, first_seed + seeds), **options)

        start = click.option(
            "--first-seed",
            metavar="K",
            type=WholeNumber(min=0),
            default=first,
            show_default=True,
            help="First seed; the other seeds follow in sequence.",
        )
        number = click.option(
            "--seeds",
            metavar="N",
            type=WholeNumber(1, MOST_SEEDS),
            default=count,
            show_default=True,
            help="Number of seeds.",
        )
        return cast(Command, number(start(with_seeds)))

    return decorate


frame_cache_option = click.option(
    "--frame-cache",
    type=PATH,
    default=Path("runs/films"),
    show_default=True,
    help="Folder for cached frames; on a cluster, all machines must share it.",
)


@dataclass(frozen=True, slots=True)
class Output:
    """How a command prints its results.

    Attributes:
        as_json: whether to print one JSON document and nothing else.
        is_quiet: whether to print neither text nor progress.
    """

    as_json: bool
    is_quiet: bool

    @property
    def is_text(self) -> bool:
        """Whether to print text."""
        return not (self.as_json or self.is_quiet)

    def results(self, to_json: Callable[[], object], show: Callable[[], None]) -> None:
        """Print results as JSON, or as text."""
        if self.as_json:
            click.echo(json.dumps(to_json(), indent=2, default=str))
        elif self.is_text:
            show()

    def lines(self, data: Mapping[str, object], *lines: object) -> None:
        """Print data as JSON, or these lines as text."""
        self.results(lambda: data, lambda: click.echo("\n".join(map(str, lines))))


def output_options(command: Callable[..., None]) -> Callable[..., None]:
    """Add --json, --quiet and --progress; the command receives an `Output` named `output`."""

    @wraps(command)
    def with_output(*arguments: Any, as_json: bool, quiet: bool, progress: str, **options: Any) -> None:
        from peopleboy.scenarios.progress_bar import ProgressStyle, progress_as

        if quiet:
            configure_logging(logging.ERROR)
        with progress_as(ProgressStyle.HIDDEN if quiet else ProgressStyle(progress)):
            command(*arguments, output=Output(as_json, quiet), **options)

    as_json = click.option("--json", "as_json", is_flag=True, help="Print the results as one JSON document.")
    quiet = click.option("--quiet", is_flag=True, help="Print only errors and the JSON of --json.")
    progress = click.option(
        "--progress",
        type=click.Choice(["auto", "plain"]),
        default="auto",
        show_default=True,
        help="Progress on standard error: plain prints a line every 30 s, for logs; auto shows a bar on a "
        "terminal and lines elsewhere.",
    )
    return as_json(quiet(progress(with_output)))


class _StandardError(logging.Handler):
    """Write to the current standard error, where a progress bar may be active."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write one log record as a line."""
        click.echo(self.format(record), err=True)


class _Formatter(logging.Formatter):
    """Format warnings as `peopleboy: note: ...`, and other records with the seconds since the start."""

    def format(self, record: logging.LogRecord) -> str:
        """Format one log record."""
        kind = "note" if record.levelno >= logging.WARNING else f"{record.relativeCreated / 1000.0:.1f} s"
        return f"peopleboy: {kind}: {record.getMessage()}"


def configure_logging(level: int = logging.WARNING) -> None:
    """Print log records of `peopleboy` at or above this level to standard error."""
    log = logging.getLogger("peopleboy")
    log.setLevel(level)
    if not any(isinstance(handler, _StandardError) for handler in log.handlers):
        handler = _StandardError()
        handler.setFormatter(_Formatter())
        log.addHandler(handler)


def _verbose_option() -> click.Option:
    def configure(context: click.Context, option: click.Parameter, value: bool) -> None:  # noqa: ARG001
        configure_logging(logging.INFO if value else logging.WARNING)

    return click.Option(
        ["--verbose"],
        is_flag=True,
        expose_value=False,
        callback=configure,
        help="Log progress and details to standard error.",
    )


def print_note(text: str) -> None:
    """Log a note about the results."""
    logging.getLogger("peopleboy").warning(text)
