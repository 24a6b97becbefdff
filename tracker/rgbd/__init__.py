"""People tracked on the floor by a depth camera with colour, on a moving robot."""
