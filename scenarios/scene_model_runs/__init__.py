"""The scene model at work on a run's frames: what it tells, with the names that the truth has for it."""
