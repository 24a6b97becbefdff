"""The only door to PyBullet: bodies by name, steps, rays, contacts and TinyRenderer's images."""
