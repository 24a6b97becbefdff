"""Several people at a time, from a standing or a moving robot."""
