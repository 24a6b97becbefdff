"""What in a depth image has the size of a human."""
