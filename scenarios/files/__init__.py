"""Scenario files: their keys, reading, validation, and the worlds that they describe."""
