"""Benchmarks of faults, kills, long runs and thousands of environments."""
