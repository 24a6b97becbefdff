"""Parts of the reference pages."""
