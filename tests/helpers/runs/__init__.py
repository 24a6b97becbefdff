"""Runs made up for tests, and one that was really exported."""
