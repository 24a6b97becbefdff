"""A run's folder: write it atomically, read it back, and check it for consistency."""
