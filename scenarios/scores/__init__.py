"""Metrics of runs and their confidence intervals."""
