"""Data for the simulator, made once from public sources."""
