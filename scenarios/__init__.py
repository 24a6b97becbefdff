"""Scenario files, the closed loop, recordings and the command line."""
