"""Parts of pages that are made from the code, so that they cannot say something else, and the pictures."""
