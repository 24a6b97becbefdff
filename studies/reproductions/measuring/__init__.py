"""Units of work, where their results are kept, and who works on them."""
