"""People in images, and how well they are found."""
