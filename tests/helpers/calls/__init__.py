"""The command line called, and what it refuses."""
