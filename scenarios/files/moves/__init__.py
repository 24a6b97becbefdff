"""What happens to things: from the actions of a scenario file to movers, and what cannot happen."""
