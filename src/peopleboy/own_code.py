"""Classes that users bring, by module:Class, and how an error in one is reported."""

import sys
import sysconfig
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from peopleboy.bad_input import BadInput

_OF_NO_USER: Final = (
    "<",  # such as <frozen importlib._bootstrap>
    str(Path(__file__).parent),
    *(sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")),
)


class OwnCodeFailed(Exception):  # noqa: N818
    """A tracker or a behaviour raised an error, which is the cause of this one.

    The message is one line that says who, when and what. The command line prints it as it is and exits with
    code 1.
    """


def load_own(what: str, name: str, call: str) -> Callable[..., Any]:
    """Find the class that "module:Class" names, where Python looks for modules, and in the working directory.

    Args:
        what: what it is to be, such as "tracker".
        name: what the user gave.
        call: how it will be called, for messages, such as "with no argument".

    Returns:
        A function that makes one; what keeps it from that is bad input.

    Raises:
        BadInput: the module cannot be imported or has no such class.
    """
    home, _, member = name.rpartition(":")
    if home.endswith(".py") or "/" in home or "\\" in home:
        module = home.replace("\\", "/").rpartition("/")[2].removesuffix(".py")
        raise BadInput(f"{what} {name!r}: {home!r} is a file's path; from its folder, give {module}:{member}")
    if (here := str(Path.cwd())) not in sys.path:
        sys.path.insert(0, here)
    try:
        found = import_module(home)
    except (ImportError, ValueError) as error:
        raise BadInput(f"{what} {name!r}: module {home!r} cannot be imported: {error}") from error
    except Exception as error:
        raise BadInput(
            f"{what} {name!r}: module {home!r} cannot be imported: {in_one_line(error)}"
        ) from error
    if not hasattr(found, member):
        raise BadInput(f"{what} {name!r}: module {home!r} has no {member!r}")

    return guarded(what, name, call, lambda *arguments: getattr(found, member)(*arguments))


def guarded(what: str, name: str, call: str, make: Callable[..., Any]) -> Callable[..., Any]:
    """Let a function of a user's own, which makes one of these, fail with one line that names it.

    Args:
        what: what it makes, such as "tracker".
        name: by which the user chose it.
        call: how it is called, for messages, such as "with no argument".
        make: the function or class.
    """

    def make_guarded(*arguments: object) -> Any:
        try:
            return make(*arguments)
        except BadInput as error:
            raise BadInput(f"{what} {name!r}: {error}") from error
        except Exception as error:
            raise BadInput(
                f"{what} {name!r}: cannot be made; it is called {call}: {in_one_line(error)}"
            ) from error

    return make_guarded


class Terminated(SystemExit):
    """The process was ended by a signal, whatever code it was in."""


@contextmanager
def blamed(who: str) -> Iterator[None]:
    """Return for an error in the block whose it is, such as "tracker 'my_module:MyTracker'".

    Raises:
        BadInput: it was raised in the block.
        OwnCodeFailed: any other error was.
    """
    try:
        yield
    except BadInput as error:
        raise BadInput(f"{who}: {error}") from error
    except Terminated:
        raise
    except (Exception, SystemExit) as error:  # it may not end the program, least of all with exit code 0
        raise OwnCodeFailed(f"{who} failed: {in_one_line(error)}") from error


@contextmanager
def at_frame(frame: int) -> Iterator[None]:
    """Return for an error in the block at which frame it was.

    Raises:
        BadInput: it was raised in the block.
        OwnCodeFailed: it was raised in the block.
    """
    try:
        yield
    except BadInput as error:
        raise BadInput(f"frame {frame}: {error}") from error
    except OwnCodeFailed as error:
        raise OwnCodeFailed(f"frame {frame}: {error}") from error.__cause__


@contextmanager
def traceback_in(path: Path) -> Iterator[None]:
    """Return for an error of such a class in the block where its traceback is kept.

    Raises:
        OwnCodeFailed: it was raised in the block.
    """
    try:
        yield
    except OwnCodeFailed as error:
        raise OwnCodeFailed(f"{error}; the traceback is in {path}") from error.__cause__


@contextmanager
def traceback_to(path: Path) -> Iterator[None]:
    """Keep the traceback of an error of such a class in the block, and tell where; an earlier one goes.

    Raises:
        OwnCodeFailed: it was raised in the block.
    """
    with suppress(NotADirectoryError):  # of an output path that is refused later
        path.unlink(missing_ok=True)
    with traceback_in(path):
        try:
            yield
        except OwnCodeFailed as error:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(traceback_of(error), encoding="utf-8")
            raise


def in_one_line(error: BaseException) -> str:
    """Return kind, message and place of an error: the last line of a user's in its traceback, or the last."""
    lines = traceback.extract_tb(error.__traceback__)
    own = [line for line in lines if not line.filename.startswith(_OF_NO_USER)]
    at = (own or lines)[-1]
    words = " ".join(f"{type(error).__name__}: {error}".split())
    if isinstance(error, SyntaxError):  # which says by itself where it is
        return words
    return f"{words} ({Path(at.filename).name}, line {at.lineno})"


def traceback_of(error: Exception) -> str:
    """Return the traceback of an error; of one in a user's class, that of its cause."""
    cause = error.__cause__ if isinstance(error, OwnCodeFailed) else None
    return "".join(traceback.format_exception(error if cause is None else cause))
