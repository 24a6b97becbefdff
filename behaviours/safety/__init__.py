"""Limits that every command passes through."""
