"""The trackers of the sources: as printed, and our best of the same kind."""
