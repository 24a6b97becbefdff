"""One page about a run, or about several side by side: what went well, what went wrong, and why."""
