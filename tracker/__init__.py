"""People in thermal and colour images: particle filters with an elliptic contour."""
