"""The contour tracker: one particle filter for each person in the thermal image."""
