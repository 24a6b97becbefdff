"""Furniture and other things: how each kind is made, and where those of a scenario stand."""
