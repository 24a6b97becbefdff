"""Tracking people all round the robot with a panoramic camera."""
