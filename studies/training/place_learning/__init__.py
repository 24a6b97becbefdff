"""Teaching the panoramic tracker to read where people stand."""
