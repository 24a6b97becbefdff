"""Small worlds, boxes around what stands in them, and who walks there."""
