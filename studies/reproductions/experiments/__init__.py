"""The sources' experiments, one file for each kind."""
