"""Controllers and trackers as your own might be, run from the root of the repository."""
