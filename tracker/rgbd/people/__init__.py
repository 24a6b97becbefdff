"""Hypotheses about people, each with a particle filter on the floor."""
