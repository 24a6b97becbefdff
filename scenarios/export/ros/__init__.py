"""Runs as bags of ROS 2."""
