"""Physics without PyBullet: a robot that rolls as its wheels turn, and is pushed out of what it meets."""
