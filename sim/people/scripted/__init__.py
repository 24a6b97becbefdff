"""People whom nothing but their scripts and the robot guide, as arrays for kernels."""
