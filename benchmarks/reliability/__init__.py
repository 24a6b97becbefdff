"""Benchmarks of what survives kills, long runs and thousands of environments."""
