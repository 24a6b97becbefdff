"""Physics: the interface to PyBullet and a kinematic alternative, with bodies by name."""
