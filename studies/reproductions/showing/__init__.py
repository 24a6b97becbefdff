"""Ours beside the sources': figures, plots, the page."""
