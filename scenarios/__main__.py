"""Lets `python -m scenarios` do what `peopleboy` does."""

from scenarios.cli import main

main()
