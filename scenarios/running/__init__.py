"""Run scenarios: single runs, seeds, suites, controller comparisons, and cached sequences of frames."""
