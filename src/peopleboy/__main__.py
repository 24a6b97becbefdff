"""Lets `python -m peopleboy` do what `peopleboy` does."""

from peopleboy.scenarios.cli import main

main()
