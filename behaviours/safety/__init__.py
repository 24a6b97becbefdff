"""Safety last: the guard that every command passes through, and its limits."""
