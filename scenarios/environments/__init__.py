"""Scenarios as gymnasium environments."""
