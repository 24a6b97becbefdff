"""Corridors: where the robot is in one, by sonar or image, and how it drives along."""
