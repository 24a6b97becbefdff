"""Detection of people in thermal images, trained on rendered images only."""
