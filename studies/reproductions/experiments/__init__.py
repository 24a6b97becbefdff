"""Experiments of the sources, one module per kind."""
