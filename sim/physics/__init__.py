"""The only door to PyBullet: bodies by name, steps, rays, contacts, models and TinyRenderer's images."""
