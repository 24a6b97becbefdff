"""Footage that others recorded: pictures, their grey, their temperatures, their truth."""
