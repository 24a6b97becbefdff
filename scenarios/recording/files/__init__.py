"""The file of a recording: packed, found, and read back."""
