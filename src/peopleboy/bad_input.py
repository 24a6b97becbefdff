"""The one error that a user's mistake raises, in every room of the project."""


class BadInput(ValueError):  # noqa: N818
    """A user's mistake: a file, flag, image or action that cannot be used.

    The message is one line that says where, what, the offending value, and what would have been right.
    The command line prints it as it is and exits with code 2.
    """
