"""Teaching the detector of people in thermal images, with rendered ones."""
