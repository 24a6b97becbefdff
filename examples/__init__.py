"""Examples of your own controllers and trackers; run them from the root of the repository."""
