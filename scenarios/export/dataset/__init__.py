"""Data sets for others to train and test on: many runs, with splits, statistics, checks and a datasheet."""
