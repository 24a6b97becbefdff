"""Walking people: bodies, gait, scripts, clothes."""
