"""Running scenarios: one, many seeds, suites, behaviours side by side, films on disk."""
