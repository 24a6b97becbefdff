"""Metrics, from the table that prints them."""

from __future__ import annotations

from docs.generate.markdown import table
from peopleboy.tracker.evaluation.table import FIGURES


def metrics(group: str) -> str:
    """List the figures of one group: thesis, paper, mot, floor or counts."""
    rows = [
        (f"**{figure.name}**", figure.unit or ("-" if figure.group == "floor" else "count"), figure.meaning)
        for figure in FIGURES
        if figure.group == group
    ]
    return table(("figure", "unit", "meaning"), rows)
