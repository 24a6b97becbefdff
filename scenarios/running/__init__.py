"""Run scenarios: one, many seeds, suites, compared controllers, and cached sequences of frames."""
