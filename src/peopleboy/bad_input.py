"""The one error that a user's mistake raises, in every room of the project."""

from collections.abc import Iterator
from contextlib import contextmanager

_LONGEST = 40  # letters shown of a key

Key = tuple[str | int, ...]
"""Steps from the top of a file to a value in it, such as ("people", 0, "path", 1, "at_m")."""


class BadInput(ValueError):  # noqa: N818
    """A user's mistake: a file, flag, image or action that cannot be used.

    The message is one line that says where, what, the offending value, and what would have been right.
    The command line prints it as it is and exits with code 2.

    Attributes:
        reason: what is wrong, and what would have been right.
        file: where it is, as the user knows the file; empty if it is in none.
        key: which value of the file it is about; empty if about the whole file.
    """

    def __init__(self, reason: str, *, file: str = "", key: Key = ()) -> None:
        super().__init__(reason)
        self.reason, self.file, self.key = reason, file, key

    def __str__(self) -> str:
        """Write it on one line: file, key, reason."""
        return ": ".join(part for part in (self.file, dotted(self.key), self.reason) if part)

    def within(self, *steps: str | int, file: str = "") -> "BadInput":
        """Return the same mistake, found below these steps of a file.

        One that is in a file of its own already is the reason for which this file cannot be used.
        """
        if self.file:
            return BadInput(str(self), file=file, key=steps)
        return BadInput(self.reason, file=file, key=(*steps, *self.key))


def dotted(key: Key) -> str:
    """Write a key as people[0].path[1].at_m."""
    names = (step if len(str(step)) <= _LONGEST else f"{str(step)[:_LONGEST]}..." for step in key)
    text = "".join(f"[{name}]" if isinstance(name, int) else f".{name}" for name in names)
    return text.removeprefix(".")


@contextmanager
def found_in(*steps: str | int, file: str = "") -> Iterator[None]:
    """Return for a mistake in the block below which steps of a file it is.

    Raises:
        BadInput: that mistake.
    """
    try:
        yield
    except BadInput as error:
        raise error.within(*steps, file=file) from error
