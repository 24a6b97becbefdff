"""Import of recorded footage: pictures, greys, temperatures, and ground truth."""
