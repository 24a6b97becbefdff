"""Controllers of your own, learned and written, run from the root of the repository."""
