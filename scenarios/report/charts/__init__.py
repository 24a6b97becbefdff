"""Charts of a report: timelines, error curves and paths."""
