"""Worlds drawn at random from a distribution that is written down, as scenario data."""
