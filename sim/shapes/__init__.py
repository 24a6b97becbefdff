"""What things are made of: shapes, their materials, and all of a world's as one table."""
