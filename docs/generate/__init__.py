"""Generated parts of pages, which are always consistent with the code, and pictures."""
