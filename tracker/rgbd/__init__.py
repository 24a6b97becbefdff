"""The RGB-D tracker: people on the floor by a depth camera with colour, on a moving robot."""
