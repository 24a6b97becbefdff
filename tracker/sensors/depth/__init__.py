"""The depth sensor: floor, walls and people in the images of a depth camera with colour."""
