"""Generated parts of the reference pages."""
