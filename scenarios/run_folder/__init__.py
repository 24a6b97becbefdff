"""A run's folder: written whole, read back, and held against itself."""
