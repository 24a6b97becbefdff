"""Reproduce the tables and figures of the sources, and write a page that compares them."""
