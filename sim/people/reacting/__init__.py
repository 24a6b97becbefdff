"""How people take to the robot: reactions, leading it, and keeping together."""
